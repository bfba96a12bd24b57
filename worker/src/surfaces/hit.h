#pragma once

#include <cstdint>

#include "math/vec3.h"

namespace nocturne {

/// Where a ray met a surface.
struct Hit {
  Vec3 position;
  /// Unit, geometric, on the side that the shape's orientation says is out (not flipped towards the
  /// ray).
  Vec3 normal;
  /// Index of the surface in the scene.
  std::uint32_t surface;
};

}  // namespace nocturne

// Geometry as a scene holds it, in metres.
#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "math/vec3.h"

namespace nocturne {

/// Front faces are counter-clockwise. Indices are checked by whoever fills it.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct Sphere {
  double x, y, z, radius;
};

using Shape = std::variant<TriangleMesh, Sphere>;

}  // namespace nocturne

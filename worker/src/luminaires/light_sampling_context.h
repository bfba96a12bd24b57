// Where a direction towards light is asked for.
#pragma once

#include <cstdint>

#include "math/vec3.h"

namespace nocturne {

struct LightSamplingContext {
  Vec3 position;
  /// Unit, on the side that the photon came from. Without `both_sides` nothing is drawn below its
  /// horizon, and the density there is zero.
  Vec3 normal;
  bool both_sides = false;
  /// Of the shutter interval, [0, 1).
  float time = 0.0f;
  /// The cell of learned light, or none.
  std::uint32_t learned = ~0u;
  /// The cell of the visible sky, or none.
  std::uint32_t visible_sky = ~0u;

  bool sees(Vec3 direction) const { return both_sides || dot(normal, direction) > 0.0f; }
};

/// Directions are rounded to float, which moves them by less than this angle. Cones that are drawn
/// from are wider by it: the density stays flat up to the rim of the emitters they hold, however
/// small.
inline constexpr double kDirectionRounding = 0x1p-21;

}  // namespace nocturne

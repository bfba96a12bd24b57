#pragma once

#include <limits>

#include "math/vec3.h"

namespace nocturne {

struct Ray {
  Vec3 origin;
  /// Unit length.
  Vec3 direction;
};

/// Moves a surface point off its surface to the side that `direction` leaves on, so that the next
/// ray does not meet the same surface. A point interpolated on its primitive is off by a few units
/// in the last place of its largest coordinate; 16 of them (2^-20 of the coordinate) clear that
/// with room.
inline Vec3 leave_surface(Vec3 position, Vec3 normal, Vec3 direction) {
  constexpr float kUnits = 16.0f * std::numeric_limits<float>::epsilon() / 2.0f;
  const float distance = kUnits * max_abs(position);
  return position + (dot(normal, direction) >= 0.0f ? distance : -distance) * normal;
}

}  // namespace nocturne

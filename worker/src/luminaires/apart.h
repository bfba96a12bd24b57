// Which elements no rounding takes for another: directions are rounded to float, and one that is
// drawn towards a triangle of a distant lamp may be one to its neighbour.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "luminaires/elements.h"
#include "math/vec3.h"

namespace nocturne {

/// Of each element, up to which distance (m) from where a direction is drawn that is so: the space
/// around its box is wider than what rounding moves, by a factor of hundred. Infinite where there
/// is no other.
inline std::vector<float> apart_up_to(const Elements& elements) {
  constexpr float kWider = 0x1p17f;  // positions and directions have 24 bits
  std::vector<float> up_to;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const ElementBounds& a = elements.bounds(i);
    float space = std::numeric_limits<float>::infinity();
    for (std::size_t j = 0; j < elements.size(); ++j) {
      if (j == i) continue;
      const ElementBounds& b = elements.bounds(j);
      const auto between = [](float low_a, float high_a, float low_b, float high_b) {
        return std::max({0.0f, low_a - high_b, low_b - high_a});
      };
      space = std::min(space, length(Vec3{between(a.low.x, a.high.x, b.low.x, b.high.x),
                                          between(a.low.y, a.high.y, b.low.y, b.high.y),
                                          between(a.low.z, a.high.z, b.low.z, b.high.z)}));
    }
    up_to.push_back(kWider * space - std::max(max_abs(a.low), max_abs(a.high)));
  }
  return up_to;
}

}  // namespace nocturne

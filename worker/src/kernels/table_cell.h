// Places between the nodes of tables that kernels interpolate.
#pragma once

#include <algorithm>
#include <cstddef>

namespace nocturne {

struct TablePlace {
  std::size_t index;
  float t;
};

/// `position` in steps from the first of `nodes`, held within them.
inline TablePlace table_place(float position, std::size_t nodes) {
  const float clamped = std::clamp(position, 0.0f, static_cast<float>(nodes - 1));
  const std::size_t index = std::min(static_cast<std::size_t>(clamped), nodes - 2);
  return {index, clamped - static_cast<float>(index)};
}

inline float mix(float a, float b, float t) { return a + t * (b - a); }

}  // namespace nocturne

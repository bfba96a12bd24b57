// Positions at equally spaced times over the shutter [0, 1], linear in between.
#pragma once

#include <algorithm>
#include <cstddef>

namespace nocturne {

/// As many as Embree takes.
inline constexpr std::size_t kMaxTimeSteps = 129;

/// Between which two steps a time is: first and first + 1, `fraction` of the distance between them.
struct TimeSegment {
  std::size_t first;
  float fraction;
};

/// At least two steps.
inline TimeSegment segment_at(float time, std::size_t steps) {
  const float position = std::clamp(time, 0.0f, 1.0f) * static_cast<float>(steps - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(position), steps - 2);
  return {first, position - static_cast<float>(first)};
}

}  // namespace nocturne

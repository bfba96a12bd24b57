// What every walk of bounds must hold.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "media/majorants.h"
#include "sampling/philox.h"
#include "sampling/sequence.h"

namespace nocturne::test {

inline Uniform4 media_numbers(std::uint32_t index, std::uint32_t seed) {
  const auto words = philox4x32({index, 0, 0, 0}, {seed, 19u});
  return {to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])};
}

/// All segments; fails unless they tile [0, end) and no two of nothing are neighbours.
template <class Density>
std::vector<MajorantSegment> segments(const Density& density, const Ray& ray, float end) {
  std::vector<MajorantSegment> all;
  typename Density::Majorants majorants(density, ray, end);
  MajorantSegment segment;
  float at = 0.0f;
  while (majorants.next(segment)) {
    EXPECT_GT(segment.end, at);
    EXPECT_GE(segment.majorant, 0.0f);
    EXPECT_FALSE(!all.empty() && segment.majorant == 0.0f && all.back().majorant == 0.0f);
    at = segment.end;
    all.push_back(segment);
    if (all.size() > 100'000) {
      ADD_FAILURE() << "no end of segments";
      break;
    }
  }
  EXPECT_EQ(at, end);
  EXPECT_FALSE(majorants.next(segment));
  return all;
}

/// Positions in single precision, as a tracer makes them, many of them near the segments' ends.
template <class Density>
void expect_bounds_hold(const Density& density, const Ray& ray, float end, std::uint32_t seed,
                        int in_each = 12) {
  const typename Density::Majorants along(density, ray, end);
  float from = 0.0f;
  std::uint32_t i = 0;
  for (const MajorantSegment& s : segments(density, ray, end)) {
    const float to = std::min(s.end, 1e30f);
    for (int k = 0; k < in_each; ++k) {
      const float u = media_numbers(i++, seed)[0];
      float t = from + u * (to - from);
      if (k == 0) t = from;
      if (k == 1) t = std::nextafter(to, from);
      if (k == 2) t = from + 1e-5f * u * (to - from);
      const float here = along.density(t);
      ASSERT_LE(here, s.majorant) << "at " << t << " in [" << from << ", " << s.end << ")";
    }
    from = s.end;
  }
}

/// Ratio of the integrated majorant to the integrated density.
template <class Density>
double waste(const Density& density, const Ray& ray, float end) {
  const typename Density::Majorants along(density, ray, end);
  double bound = 0.0, there = 0.0, from = 0.0;
  for (const MajorantSegment& s : segments(density, ray, end)) {
    const double to = static_cast<double>(s.end);
    bound += static_cast<double>(s.majorant) * (to - from);
    for (int k = 0; k < 1000; ++k) {
      const auto t = static_cast<float>(from + (k + 0.5) / 1000.0 * (to - from));
      there += static_cast<double>(along.density(t)) * (to - from) / 1000;
    }
    from = to;
  }
  return bound / there;
}

}  // namespace nocturne::test

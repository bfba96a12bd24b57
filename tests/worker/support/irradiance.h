// Estimates of irradiance from a sampler of directions, and the z-test that compares them with an
// answer on paper.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>

#include "luminaires/light_sampling_context.h"
#include "luminaires/on_half_line.h"
#include "sampling/philox.h"
#include "sampling/sequence.h"
#include "support/effort.h"

namespace nocturne::test {

/// Independent uniform numbers number i.
inline Uniform4 numbers(std::uint32_t i, std::uint32_t stream = 0) {
  const auto words = philox4x32({i, stream, 0, 0}, {2026u, 12u});
  return {to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])};
}

struct Estimate {
  double mean = 0.0, variance = 0.0;  // variance of one draw
  double draws = 0.0;

  double stderr_of_mean() const { return std::sqrt(variance / draws); }
  double relative_spread() const { return std::sqrt(variance) / mean; }
};

/// The mean of `value` over draws 0 .. count - 1.
inline Estimate estimate(std::uint32_t count, const std::function<double(const Uniform4&)>& value) {
  double sum = 0.0, squares = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double v = value(numbers(i));
    EXPECT_TRUE(std::isfinite(v) && v >= 0.0);
    sum += v;
    squares += v * v;
  }
  const double n = count, mean = sum / n;
  return {mean, std::max(0.0, squares / n - mean * mean), n};
}

inline Vec3 direction_of(Vec3 direction) { return direction; }
inline Vec3 direction_of(const DrawnDirection& drawn) { return drawn.direction; }

/// radiance x cosine / pdf, for any sampler with the usual interface.
template <class Directions, class Radiance>
Estimate irradiance(const Directions& directions, const LightSamplingContext& from,
                    const Radiance& radiance, std::uint32_t count = 100'000) {
  return estimate(part_of(count), [&](const Uniform4& u) {
    const auto drawn = directions.sample(from, u[0], u[1], u[2]);
    if (!drawn) return 0.0;
    const Vec3 w = direction_of(*drawn);
    const float pdf = directions.pdf(from, w);
    if (!(pdf > 0.0f)) return 0.0;
    return std::fabs(static_cast<double>(dot(from.normal, w))) * radiance(w) / pdf;
  });
}

/// Two-sided at 4.5 sigma (one false alarm in 150,000); an estimate without any noise must meet
/// the answer to float's rounding.
inline void expect_mean(const Estimate& e, double answer, double rounding = 1e-5) {
  EXPECT_NEAR(e.mean, answer, 4.5 * e.stderr_of_mean() + rounding * answer)
      << "relative standard error " << e.stderr_of_mean() / answer;
}

}  // namespace nocturne::test

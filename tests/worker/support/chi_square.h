// Does a sampler draw what its pdf says? Pearson's chi-square test over cells, and the integral of
// the pdf, in one place for every sampler of directions.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "math/vec3.h"
#include "pdfs/directions.h"
#include "sampling/philox.h"
#include "sampling/sequence.h"

namespace nocturne::test {

/// Standard normal deviate of a chi-square statistic (Wilson and Hilferty, PNAS 17, 1931).
inline double chi_square_deviate(double statistic, double degrees) {
  const double a = 2.0 / (9.0 * degrees);
  return (std::cbrt(statistic / degrees) - (1.0 - a)) / std::sqrt(a);
}

/// Observed and expected counts; cells that expect fewer than 10 are pooled. One false alarm in
/// 30,000 (4 sigma).
inline void expect_same_counts(const std::vector<double>& observed,
                               const std::vector<double>& expected) {
  double statistic = 0.0, pooled_observed = 0.0, pooled_expected = 0.0;
  int cells = 0;
  const auto add = [&](double o, double e) {
    statistic += (o - e) * (o - e) / e;
    ++cells;
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] >= 10.0) {
      add(observed[i], expected[i]);
    } else {
      pooled_observed += observed[i];
      pooled_expected += expected[i];
    }
  }
  if (pooled_expected >= 10.0) {
    add(pooled_observed, pooled_expected);
  } else {
    // Draws where (almost) none belong.
    EXPECT_LE(pooled_observed, pooled_expected + 20.0);
  }
  ASSERT_GT(cells, 1);
  EXPECT_LT(chi_square_deviate(statistic, cells - 1), 4.0)
      << "chi-square " << statistic << " with " << cells - 1 << " degrees of freedom";
}

using SampleDirection = std::function<std::optional<Vec3>(const Uniform4&)>;
using DirectionPdf = std::function<float(Vec3)>;

/// Cells equal in cos(theta) and phi around z. A draw without a direction counts as missing: it
/// must be as rare as the integral of the pdf falls short of 1. `parts` is how finely the pdf is
/// integrated inside a cell, along each side.
inline void expect_samples_match_pdf(const SampleDirection& sample, const DirectionPdf& pdf,
                                     int parts = 48) {
  constexpr int kRows = 16, kColumns = 24, kDraws = 200'000;
  std::vector<double> observed(kRows * kColumns), expected(kRows * kColumns);
  int drawn = 0;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const auto words = philox4x32({i, 0, 0, 0}, {2026u, 11u});
    const auto w =
        sample({to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])});
    if (!w) continue;
    ++drawn;
    const double phi = std::atan2(w->y, w->x) / (2.0 * std::numbers::pi) + 0.5;
    const int row = std::min(kRows - 1, static_cast<int>((w->z + 1.0) / 2.0 * kRows));
    const int column = std::min(kColumns - 1, static_cast<int>(phi * kColumns));
    observed[static_cast<std::size_t>(row * kColumns + column)] += 1.0;
  }
  double integral = 0.0;
  const double solid_angle = 4.0 * std::numbers::pi / (kRows * kColumns * parts * parts);
  for (int row = 0; row < kRows * parts; ++row) {
    const double z = 2.0 * (row + 0.5) / (kRows * parts) - 1.0, r = std::sqrt(1.0 - z * z);
    for (int column = 0; column < kColumns * parts; ++column) {
      const double phi = 2.0 * std::numbers::pi * ((column + 0.5) / (kColumns * parts) - 0.5);
      const Vec3 w{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
                   static_cast<float>(z)};
      const double share = pdf(w) * solid_angle;
      integral += share;
      expected[static_cast<std::size_t>(row / parts * kColumns + column / parts)] += share * kDraws;
    }
  }
  EXPECT_NEAR(integral, static_cast<double>(drawn) / kDraws, 5e-3);
  expect_same_counts(observed, expected);
}

}  // namespace nocturne::test

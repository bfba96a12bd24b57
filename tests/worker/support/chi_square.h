// Does a sampler draw what its pdf says? Pearson's chi-square test over cells, and the integral of
// the pdf, in one place for every sampler of directions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "math/frame.h"
#include "math/vec3.h"
#include "pdfs/directions.h"
#include "sampling/philox.h"
#include "sampling/sequence.h"
#include "support/effort.h"

namespace nocturne::test {

/// Standard normal deviate of a chi-square statistic (Wilson and Hilferty, PNAS 17, 1931).
inline double chi_square_deviate(double statistic, double degrees) {
  const double a = 2.0 / (9.0 * degrees);
  return (std::cbrt(statistic / degrees) - (1.0 - a)) / std::sqrt(a);
}

/// Observed and expected counts. Neighbours are taken together until 10 are expected, and the
/// remainder at the end joins the last. One false alarm in 30,000 (4 sigma).
inline void expect_same_counts(const std::vector<double>& observed,
                               const std::vector<double>& expected) {
  struct Cell {
    double observed = 0.0, expected = 0.0;
  };
  std::vector<Cell> cells;
  Cell open, all;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    open.observed += observed[i];
    open.expected += expected[i];
    all.observed += observed[i];
    all.expected += expected[i];
    if (open.expected < 10.0) continue;
    cells.push_back(open);
    open = {};
  }
  if (cells.size() < 2) {
    // (Almost) nothing belongs anywhere: a Poisson count, bounded as 4 sigma above its mean, with
    // room for the skewness of small means.
    EXPECT_LE(all.observed, all.expected + 4.0 * std::sqrt(all.expected) + 6.0);
    return;
  }
  cells.back().observed += open.observed;
  cells.back().expected += open.expected;
  double statistic = 0.0;
  for (const Cell& cell : cells) {
    const double off = cell.observed - cell.expected;
    statistic += off * off / cell.expected;
  }
  const auto degrees = static_cast<double>(cells.size() - 1);
  EXPECT_LT(chi_square_deviate(statistic, degrees), 4.0)
      << "chi-square " << statistic << " with " << degrees << " degrees of freedom";
}

using SampleDirection = std::function<std::optional<Vec3>(const Uniform4&)>;
using DirectionPdf = std::function<float(Vec3)>;

/// Where cells lie: rows x in [0, 1] around `axis`, 1 - cos = 2 x^power. Power 1 makes cells of
/// equal solid angle; a sharp lobe wants its own axis and a power of 4.
struct Chart {
  Vec3 axis{0.0f, 0.0f, 1.0f};
  double power = 1.0;
};

/// A draw without a direction counts as missing: it must be as rare as the integral of the pdf
/// falls short of 1, within 4 standard errors of a count, or 5e-3 for the quadrature. `parts` is
/// how finely the pdf is integrated inside a cell, along each side.
inline void expect_samples_match_pdf(const SampleDirection& sample, const DirectionPdf& pdf,
                                     int parts = 48, const Chart& chart = {},
                                     std::uint32_t all_draws = 200'000) {
  constexpr int kRows = 16, kColumns = 24;
  const std::uint32_t draws = part_of(all_draws);
  const Frame frame(chart.axis);
  std::vector<double> observed(kRows * kColumns), expected(kRows * kColumns);
  std::uint32_t drawn = 0;
  for (std::uint32_t i = 0; i < draws; ++i) {
    const auto words = philox4x32({i, 0, 0, 0}, {2026u, 11u});
    const auto w =
        sample({to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])});
    if (!w) continue;
    ++drawn;
    const Vec3 local = frame.to_local(*w);
    const Vec3 off = *w - chart.axis;  // |off|^2 / 2 is 1 - cos, without cancellation
    const double x =
        std::pow(std::min(1.0, 0.25 * static_cast<double>(dot(off, off))), 1.0 / chart.power);
    const double phi =
        static_cast<double>(std::atan2(local.y, local.x)) / (2.0 * std::numbers::pi) + 0.5;
    const int row = std::min(kRows - 1, static_cast<int>(x * kRows));
    const int column = std::min(kColumns - 1, static_cast<int>(phi * kColumns));
    observed[static_cast<std::size_t>(row * kColumns + column)] += 1.0;
  }
  double integral = 0.0;
  for (int row = 0; row < kRows * parts; ++row) {
    const double side = kRows * parts;
    const double middle = 2.0 * std::pow((row + 0.5) / side, chart.power);  // 1 - cos
    const double z = 1.0 - middle, r = std::sqrt(middle * (2.0 - middle));
    const double solid_angle =
        (std::pow((row + 1) / side, chart.power) - std::pow(row / side, chart.power)) * 4.0 *
        std::numbers::pi / (kColumns * parts);
    for (int column = 0; column < kColumns * parts; ++column) {
      const double phi = 2.0 * std::numbers::pi * ((column + 0.5) / (kColumns * parts) - 0.5);
      const Vec3 local{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
                       static_cast<float>(z)};
      const double share = static_cast<double>(pdf(frame.to_world(local))) * solid_angle;
      integral += share;
      expected[static_cast<std::size_t>(row / parts * kColumns + column / parts)] += share * draws;
    }
  }
  const double found = static_cast<double>(drawn) / draws;
  EXPECT_NEAR(integral, found, std::max(5e-3, 4.0 * std::sqrt(found * (1.0 - found) / draws)));
  expect_same_counts(observed, expected);
}

}  // namespace nocturne::test

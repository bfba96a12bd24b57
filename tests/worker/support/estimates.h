// Pixels of a tile against an answer on paper.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tile/tile_sums.h"

namespace nocturne::test {

struct Estimate {
  double y, standard_error;
};

inline Estimate estimate(const TileSums& tile, std::size_t pixel, double n) {
  const double* sums = &tile.sums[tile.channels * pixel];
  const double variance = (sums[3] - sums[1] * sums[1] / n) / (n * (n - 1.0));
  return {sums[1] / n, std::sqrt(std::max(0.0, variance))};
}

inline Estimate estimate_mean(const TileSums& tile, double n) {
  const std::size_t pixels = tile.sums.size() / tile.channels;
  double mean = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const Estimate e = estimate(tile, i, n);
    mean += e.y / static_cast<double>(pixels);
    variance += e.standard_error * e.standard_error;
  }
  return {mean, std::sqrt(variance) / static_cast<double>(pixels)};
}

/// Every pixel within z standard errors and the rounding of single precision chains (1e-5 of the
/// truth), and the mean of all pixels within 4: 256 pixels at 4.4 and one mean give one false alarm
/// in 350 for independent samples, where seeds are fixed; stratified ones do better.
inline void expect_all_pixels(const TileSums& tile, double n, double truth) {
  const std::size_t pixels = tile.sums.size() / tile.channels;
  for (std::size_t i = 0; i < pixels; ++i) {
    const Estimate e = estimate(tile, i, n);
    ASSERT_NEAR(e.y, truth, 4.4 * e.standard_error + 1e-5 * truth) << "pixel " << i;
  }
  const Estimate mean = estimate_mean(tile, n);
  EXPECT_NEAR(mean.y, truth, 4.0 * mean.standard_error + 1e-5 * truth);
  EXPECT_EQ(tile.invalid_samples, 0u);
}

}  // namespace nocturne::test

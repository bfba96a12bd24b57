#include "spectrum/wavelength_density.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sensors/wavelengths.h"

namespace nocturne {
namespace {

// As curves of the eye fall off: eight powers of ten in cells of 1 nm.
DensityTable falls() {
  DensityTable table;
  for (int i = 0; i <= 400; ++i) {
    table.knots_nm.push_back(380.0f + static_cast<float>(i));
    table.values.push_back(static_cast<float>(std::exp(-std::pow((i - 170) / 50.0, 2))));
  }
  return table;
}

// Samples have the given density, except for the rounding by parabolas, which adds less than a
// hundredth to the variance of an even spectrum.
TEST(WavelengthDensity, WeightsAreNearlyEven) {
  const auto mean_square = [](const DensityTable& table) {
    const WavelengthDensity density(table.knots_nm, table.values);
    double area = 0.0;
    for (std::size_t i = 1; i < table.values.size(); ++i) {
      area += 0.5 * static_cast<double>(table.knots_nm[i] - table.knots_nm[i - 1]) *
              static_cast<double>(table.values[i] + table.values[i - 1]);
    }
    constexpr int kDraws = 1'000'000;
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const auto draw = density.sample(Spectral<1>((static_cast<float>(i) + 0.5f) / kDraws));
      const auto after =
          std::upper_bound(table.knots_nm.begin() + 1, table.knots_nm.end() - 1, draw.nm[0]) -
          table.knots_nm.begin();
      const auto high = static_cast<std::size_t>(after);
      const double width = table.knots_nm[high] - table.knots_nm[high - 1];
      const double t =
          width > 0.0 ? static_cast<double>(draw.nm[0] - table.knots_nm[high - 1]) / width : 0.0;
      const double asked = table.values[high - 1] +
                           t * static_cast<double>(table.values[high] - table.values[high - 1]);
      const double weight = asked / area * static_cast<double>(draw.inverse_density[0]);
      mean += weight / kDraws;
      square += weight * weight / kDraws;
    }
    EXPECT_NEAR(mean, 1.0, 1e-3);
    return square;
  };
  EXPECT_LT(mean_square({{0.0f, 1.0f, 3.0f}, {0.0f, 2.0f, 0.0f}}), 1.001);
  // Two lines of 0.01 nm on a flat ground.
  EXPECT_LT(
      mean_square({{400.0f, 588.985f, 588.995f, 589.005f, 589.582f, 589.592f, 589.602f, 700.0f},
                   {0.002f, 0.002f, 30.0f, 0.002f, 0.002f, 15.0f, 0.002f, 0.002f}}),
      1.01);
  EXPECT_LT(mean_square(falls()), 1.01);
  // A gap that is not quite dark before a line: its samples must not come from the line's part.
  EXPECT_LT(mean_square({{400.0f, 450.0f, 499.99f, 500.0f, 500.01f, 550.0f},
                         {1e-7f, 1e-7f, 1e-7f, 100.0f, 1e-7f, 1e-7f}}),
            1.01);
}

// Without other noise, convergence depends on the smoothness of the density: a thousand regular
// draws find an integral to a hundred-thousandth. Densities that are even in each slice miss it by
// thirty times as much.
TEST(WavelengthDensity, IsSmoothWhereCurvesAre) {
  const DensityTable curve = falls();
  const auto value = [&values = curve.values](double nm) {
    const double x = std::min(nm - 380.0, 399.999);
    const auto cell = static_cast<std::size_t>(x);
    const double t = x - static_cast<double>(cell);
    return (values[cell] + t * static_cast<double>(values[cell + 1] - values[cell])) *
           (1.0 + 0.5 * std::cos(nm / 40.0));
  };
  constexpr int kPoints = 4'000'000, kDraws = 1000;
  double truth = 0.0, found = 0.0;
  for (int i = 0; i < kPoints; ++i)
    truth += 400.0 / kPoints * value(380.0 + 400.0 * (i + 0.5) / kPoints);
  const WavelengthDensity density(curve.knots_nm, curve.values);
  for (int i = 0; i < kDraws; ++i) {
    const auto draw = density.sample(Spectral<1>((static_cast<float>(i) + 0.5f) / kDraws));
    found += static_cast<double>(draw.inverse_density[0]) * value(draw.nm[0]) / kDraws;
  }
  EXPECT_NEAR(found / truth, 1.0, 1e-5);
}

// Straight pieces are inverted exactly, also where they begin or end at zero.
TEST(WavelengthDensity, Wedges) {
  const WavelengthDensity density({0.0f, 1.0f, 3.0f}, {0.0f, 2.0f, 0.0f});
  for (const float u : {0.0f, 1e-7f, 0.01f, 0.2f, 0.5f, 0.9f, 0x1.fffffep-1f}) {
    const auto all = density.sample(Spectral<1>(u));
    const float nm = all.nm[0], inverse_density = all.inverse_density[0];
    // Areas of triangles: x^2 of 3 below 1, (3 - x)^2 / 2 of 3 above.
    const double x = nm;
    const double below = x < 1.0 ? x * x / 3.0 : 1.0 - (3.0 - x) * (3.0 - x) / 6.0;
    EXPECT_NEAR(below, u, 2e-7);
    EXPECT_TRUE(std::isfinite(inverse_density));
    if (u > 0.001f && u < 0.999f) {
      EXPECT_NEAR(density.pdf(nm) * inverse_density, 1.0, 1e-5);
    }
  }
}

}  // namespace
}  // namespace nocturne

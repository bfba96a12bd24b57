#include "sensors/wavelengths.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/chi_square.h"

namespace nocturne {
namespace {

ResponseCurves curves() {
  ResponseCurves c{400.0f, 10.0f, {}, {}, {}};
  for (int i = 0; i <= 30; ++i) {
    const auto bump = [&](double centre) {
      return static_cast<float>(std::exp(-std::pow((10 * i - centre) / 40.0, 2)));
    };
    c.x.push_back(bump(200));
    c.y.push_back(bump(150));
    c.z.push_back(i > 20 ? 0.0f : bump(50));
  }
  return c;
}

class Wavelengths : public testing::TestWithParam<bool> {};

TEST_P(Wavelengths, SamplesMatchPdf) {
  const WavelengthSampler sampler(curves(), GetParam());
  constexpr int kDraws = 100'000, kCells = 60;
  std::vector<double> observed(kCells), expected(kCells);
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const float u = to_unit(philox4x32({i, 0, 0, 0}, {3, 4})[0]);
    const float nm = sampler.sample(u).nm;
    observed[static_cast<std::size_t>(
        std::min(kCells - 1, static_cast<int>((nm - 400.0f) / 5.0f)))] += 1.0;
  }
  double integral = 0.0;
  for (int cell = 0; cell < kCells; ++cell) {
    const double share = 5.0 * sampler.pdf(400.0f + 5.0f * (static_cast<float>(cell) + 0.5f));
    expected[static_cast<std::size_t>(cell)] = share * kDraws;
    integral += share;
  }
  EXPECT_NEAR(integral, 1.0, 1e-5);
  test::expect_same_counts(observed, expected);
}

TEST_P(Wavelengths, MeanWeightIsTheIntegralOfTheResponse) {
  const ResponseCurves c = curves();
  const WavelengthSampler sampler(c, GetParam());
  constexpr int kDraws = 200'000;
  std::array<double, 3> mean{};
  for (int i = 0; i < kDraws; ++i) {
    const auto sample = sampler.sample((static_cast<float>(i) + 0.5f) / kDraws);
    for (std::size_t k = 0; k < 3; ++k) mean[k] += sample.weight[k] / kDraws;
  }
  const std::array<const std::vector<float>*, 3> all{&c.x, &c.y, &c.z};
  for (std::size_t k = 0; k < 3; ++k) {
    double integral = 0.0;
    for (std::size_t i = 0; i + 1 < all[k]->size(); ++i)
      integral += 5.0 * ((*all[k])[i] + (*all[k])[i + 1]);
    EXPECT_NEAR(mean[k], integral, 2e-4 * integral);
  }
}

TEST_P(Wavelengths, EndsOfTheUnitIntervalStayOnTheGrid) {
  const WavelengthSampler sampler(curves(), GetParam());
  EXPECT_GE(sampler.sample(0.0f).nm, 400.0f);
  EXPECT_LE(sampler.sample(0x1.fffffep-1f).nm, 700.0f);
}

INSTANTIATE_TEST_SUITE_P(UniformAndResponse, Wavelengths, testing::Bool());

TEST(WavelengthSampler, RefusesCurvesThatMeanNothing) {
  EXPECT_THROW(WavelengthSampler({400, 10, {0, 0}, {0, 0}, {0, 0}}, true), std::invalid_argument);
  EXPECT_THROW(WavelengthSampler({400, 10, {1, 1}, {1}, {1, 1}}, true), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

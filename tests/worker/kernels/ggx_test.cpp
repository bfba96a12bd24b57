#include "kernels/ggx.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

TEST(Ggx, FacetsCoverTheSurfaceOnce) {
  for (const auto& [u, v] : {std::pair{0.05f, 0.05f}, {0.5f, 0.5f}, {1.0f, 1.0f}, {0.1f, 0.6f}}) {
    const Ggx ggx{u, v};
    // Midpoints in slope space, tan = x / (1 - x), which is smooth for GGX.
    double sum = 0.0;
    constexpr int kSteps = 1000;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; j < kSteps / 4; ++j) {
        const double x = (i + 0.5) / kSteps, tangent = static_cast<double>(u) * x / (1.0 - x);
        const double phi = 2.0 * std::numbers::pi * (j + 0.5) / (kSteps / 4);
        const double cosine = 1.0 / std::sqrt(1.0 + tangent * tangent), r = tangent * cosine;
        const Vec3 h{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
                     static_cast<float>(cosine)};
        const double slope_cell = static_cast<double>(u) / ((1.0 - x) * (1.0 - x)) / kSteps * 2.0 *
                                  std::numbers::pi / (kSteps / 4) * tangent;
        sum += static_cast<double>(ggx.density(h)) * cosine * slope_cell * cosine * cosine * cosine;
      }
    }
    EXPECT_NEAR(sum, 1.0, 1e-4);
  }
}

TEST(Ggx, VisibleNormalsAlongTheNormalAreProjectedFacets) {
  // P(cos^2 of h > c) for projected facets: tan^2 = alpha^2 u / (1 - u), so the median of tan is
  // alpha.
  for (const float alpha : {1e-4f, 0.01f, 0.5f, 1.0f}) {
    const Ggx ggx{alpha, alpha};
    const auto below = test::mean_of(40'000, [&](std::uint32_t i) {
      const auto u = test::numbers(i, 3);
      const Vec3 h = ggx.sample_visible({0.0f, 0.0f, 1.0f}, u[0], u[1]);
      return std::hypot(h.x, h.y) < alpha * h.z ? 1.0 : 0.0;
    });
    EXPECT_NEAR(below.value, 0.5, 4.0 * below.standard_error);
  }
}

TEST(Ggx, BetaIsEulersIntegral) {
  EXPECT_NEAR(beta_1p(1.0, 1.0), 1.0 / 6.0, 1e-12);
  EXPECT_NEAR(beta_1p(2.0, 3.0), 1.0 / 60.0, 1e-12);
  EXPECT_NEAR(beta_1p(0.5, 0.5), std::numbers::pi / 8.0, 1e-12);
  EXPECT_NEAR(beta_1p(0.0, 7.0), 1.0 / 8.0, 1e-15);
  EXPECT_NEAR(beta_1p(1e-9, 7.0), 1.0 / 8.0, 1e-8);
  EXPECT_NEAR(beta_1p(40.0, 0.25) / (std::tgamma(41.0) * std::tgamma(1.25) / std::tgamma(42.25)),
              1.0, 1e-11);
  EXPECT_EQ(beta_1p(3.0, 11.0), beta_1p(11.0, 3.0));
}

}  // namespace
}  // namespace nocturne

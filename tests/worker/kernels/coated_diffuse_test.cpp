#include "kernels/coated_diffuse.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

BoundCoatedDiffuse<1> bound(float index, float u, float v, float reflectance) {
  return CoatedDiffuse(Spectrum(index), {Scalar(u), Scalar(v)}, Colour(Spectrum(reflectance)))
      .bind(Shading<1>{.wavelengths = 550.0f});
}

// A white base under a clear smooth coat loses nothing.
TEST(CoatedDiffuse, WhiteBaseUnderSmoothCoatReflectsEverything) {
  for (const double degrees : {0.0, 60.0, 89.0}) {
    const auto mean =
        test::sampled_albedo(bound(1.5f, 0.0f, 0.0f, 1.0f), test::direction(degrees), 200'000);
    EXPECT_NEAR(mean.value, 1.0, 4.0 * mean.standard_error + 1e-5) << degrees;
  }
}

// Follows the light: through the coat, between base and coat, out again.
TEST(CoatedDiffuse, SmoothCoatIsTheSumOfAllBounces) {
  const double n = 1.5, base = 0.6, f = fresnel_dielectric(0.8, n);
  const double inside = hemispherical_reflectance(1.0 / n);
  double sum = f, travelling = 1.0 - f;
  for (int bounce = 0; bounce < 200; ++bounce) {
    travelling *= base;
    sum += travelling * (1.0 - inside);
    travelling *= inside;
  }
  EXPECT_NEAR(bound(1.5f, 0.0f, 0.0f, 0.6f).albedo({0.6f, 0.0f, 0.8f})[0], sum, 1e-6);
}

TEST(CoatedDiffuse, ConservesEnergy) {
  for (const float index : {1.0001f, 1.3f, 1.5f, 2.4f, 4.0f}) {
    for (const auto& [u, v] : {std::pair{0.01f, 0.01f},
                               {0.1f, 0.1f},
                               {0.5f, 0.5f},
                               {1.0f, 1.0f},
                               {0.05f, 0.5f},
                               {0.01f, 1.0f}}) {
      const auto kernel = bound(index, u, v, 1.0f);
      for (const double degrees : {0.0, 45.0, 75.0, 88.0}) {
        for (const double azimuth : {0.0, 90.0}) {
          const auto mean = test::sampled_albedo(kernel, test::direction(degrees, azimuth), 4'000);
          EXPECT_LE(mean.value, 1.0 + 4.5 * mean.standard_error + 1e-3)
              << index << " " << u << " " << v << " " << degrees << " " << azimuth;
        }
      }
    }
  }
}

TEST(CoatedDiffuse, IsReciprocal) {
  for (const float alpha : {0.0f, 0.2f, 0.8f}) {
    const auto kernel = bound(1.5f, alpha, 0.5f * alpha, 0.7f);
    EXPECT_LT(test::largest_asymmetry(kernel), 1e-4f);
  }
}

// The smooth limit of the rough coat is the smooth coat: no step where roughness sets in.
TEST(CoatedDiffuse, RoughCoatEndsInTheSmoothOne) {
  const Vec3 wo = test::direction(50.0);
  EXPECT_NEAR(bound(1.5f, 2e-4f, 2e-4f, 0.6f).albedo(wo)[0],
              bound(1.5f, 0.0f, 0.0f, 0.6f).albedo(wo)[0], 2e-4);
}

}  // namespace
}  // namespace nocturne

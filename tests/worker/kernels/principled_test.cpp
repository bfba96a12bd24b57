#include "kernels/principled.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

struct Parameters {
  float base = 0.8f, metallic = 0.0f, roughness = 0.5f, index = 1.5f, coat = 0.0f,
        coat_roughness = 0.0f;
};

BoundPrincipled<1> bound(const Parameters& p) {
  return Principled(Colour(Spectrum(p.base)), Scalar(p.metallic), Scalar(p.roughness),
                    Spectrum(p.index), {Scalar(p.coat), Scalar(p.coat_roughness), 1.5f})
      .bind(Shading<1>{.wavelengths = 550.0f});
}

// In a white furnace metal loses nothing, a rough dielectric over white at most what principled.h
// says.
TEST(Principled, WhiteSurfacesReflectEverything) {
  for (const float metallic : {0.0f, 0.5f, 1.0f}) {
    for (const float roughness : {0.0f, 0.2f, 0.5f, 0.8f, 1.0f}) {
      for (const double degrees : {0.0, 45.0, 75.0}) {
        const auto mean = test::sampled_albedo(
            bound({.base = 1.0f, .metallic = metallic, .roughness = roughness}),
            test::direction(degrees), 40'000);
        const double noise = 4.5 * mean.standard_error;
        EXPECT_LE(mean.value, 1.0 + noise + 0.005)
            << metallic << " " << roughness << " " << degrees;
        EXPECT_GE(mean.value, 1.0 - noise - 0.005 - (metallic < 1.0f ? 0.015 : 0.0))
            << metallic << " " << roughness << " " << degrees;
      }
    }
  }
}

// A coat over anything gains nothing.
TEST(Principled, ConservesEnergy) {
  for (const float metallic : {0.0f, 1.0f}) {
    for (const float roughness : {0.0f, 0.3f, 1.0f}) {
      for (const float index : {1.0f, 1.3f, 2.4f}) {
        for (const float coat_roughness : {0.0f, 0.5f, 1.0f}) {
          const auto kernel = bound({.base = 1.0f,
                                     .metallic = metallic,
                                     .roughness = roughness,
                                     .index = index,
                                     .coat = 1.0f,
                                     .coat_roughness = coat_roughness});
          for (const double degrees : {0.0, 45.0, 75.0, 88.0}) {
            const auto mean = test::sampled_albedo(kernel, test::direction(degrees), 10'000);
            EXPECT_LE(mean.value, 1.0 + 4.5 * mean.standard_error + 0.005)
                << metallic << " " << roughness << " " << index << " " << coat_roughness << " "
                << degrees;
          }
        }
      }
    }
  }
}

// E + (1 - E) base leaves a smooth dielectric over a diffuse base.
TEST(Principled, BaseGetsWhatTheDielectricLets) {
  for (const double degrees : {0.0, 45.0, 80.0}) {
    const Vec3 wo = test::direction(degrees);
    const auto e = fresnel_dielectric<double>(static_cast<double>(wo.z), 1.5);
    const auto mean = test::sampled_albedo(bound({.base = 0.6f, .roughness = 0.0f}), wo, 200'000);
    EXPECT_NEAR(mean.value, e + (1.0 - e) * 0.6, 4.5 * mean.standard_error + 1e-4) << degrees;
  }
}

TEST(Principled, IsReciprocal) {
  for (const float metallic : {0.0f, 0.3f, 1.0f}) {
    for (const float coat : {0.0f, 0.7f}) {
      const auto kernel =
          bound({.metallic = metallic, .roughness = 0.4f, .coat = coat, .coat_roughness = 0.3f});
      EXPECT_LT(test::largest_asymmetry(kernel), 1e-4f);
    }
  }
}

// What says that it holds no delta lobe draws none.
TEST(Principled, SaysWhereItIsAMirror) {
  const auto kernel = [](float roughness, float coat, float coat_roughness) {
    return Principled(Colour(Spectrum(0.5f)), Scalar(0.0f), Scalar(roughness), Spectrum(1.5f),
                      {Scalar(coat), Scalar(coat_roughness), 1.5f});
  };
  EXPECT_FALSE(kernel(0.5f, 0.0f, 0.0f).has_delta_lobe());
  EXPECT_TRUE(kernel(0.5f, 0.1f, 0.0f).has_delta_lobe());
  EXPECT_TRUE(kernel(0.0f, 0.0f, 0.5f).has_delta_lobe());
  EXPECT_FALSE(kernel(0.5f, 1.0f, 0.5f).has_delta_lobe());
}

}  // namespace
}  // namespace nocturne

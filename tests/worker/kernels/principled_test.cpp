#include "kernels/principled.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

struct Parameters {
  float base = 0.8f, metallic = 0.0f, roughness = 0.5f, index = 1.5f, coat = 0.0f,
        coat_roughness = 0.0f;
  Principled::Extras extras = {};
};

BoundPrincipled<1> bound(const Parameters& p) {
  return Principled(Colour(Spectrum(p.base)), Scalar(p.metallic), Scalar(p.roughness),
                    Spectrum(p.index), {Scalar(p.coat), Scalar(p.coat_roughness), 1.5f}, p.extras)
      .bind(Shading<1>{.wavelengths = 550.0f});
}

Principled::Fuzz fuzz(float colour, float roughness) {
  return {Colour(Spectrum(colour)), Scalar(roughness)};
}
Principled::Brush brush(float roughness, float rotation) {
  return {Scalar(roughness), Scalar(rotation)};
}
Principled::Reflectance reflectance(float amount, float normal) {
  return {Scalar(amount), Colour(Spectrum(normal))};
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

// Fuzz over white, and a dielectric of any reflectance over white, gain nothing; brushed facets
// what the tables of even ones are off by.
TEST(Principled, ExtrasConserveEnergy) {
  for (const float metallic : {0.0f, 1.0f}) {
    for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f}) {
      for (const auto& extras : {Principled::Extras{.sheen = fuzz(1.0f, 0.0f)},
                                 Principled::Extras{.sheen = fuzz(1.0f, 0.3f)},
                                 Principled::Extras{.sheen = fuzz(1.0f, 1.0f)},
                                 Principled::Extras{.sheen = fuzz(0.5f, 0.5f)},
                                 Principled::Extras{.reflectance = reflectance(1.0f, 1.0f)},
                                 Principled::Extras{.reflectance = reflectance(1.0f, 0.3f)},
                                 Principled::Extras{.reflectance = reflectance(0.5f, 0.0f)},
                                 Principled::Extras{.brush = brush(0.1f, 0.1f)},
                                 Principled::Extras{.brush = brush(0.7f, 0.0f)}}) {
        const auto kernel =
            bound({.base = 1.0f, .metallic = metallic, .roughness = roughness, .extras = extras});
        for (const double degrees : {0.0, 45.0, 75.0, 88.0}) {
          for (const double azimuth : {0.0, 30.0, 90.0}) {
            if (azimuth > 0.0 && !extras.brush) continue;
            const auto mean =
                test::sampled_albedo(kernel, test::direction(degrees, azimuth), 5'000);
            EXPECT_LE(mean.value, 1.0 + 4.5 * mean.standard_error + 0.005)
                << metallic << " " << roughness << " " << degrees << " " << azimuth << " sheen "
                << extras.sheen.has_value() << " brush " << extras.brush.has_value();
          }
        }
      }
    }
  }
}

// Without a base and without fuzz the albedo at normal incidence is the given one.
TEST(Principled, ReflectsWhatIsAskedForAlongTheNormal) {
  const Vec3 wo = test::direction(0.0);
  const auto of = [&](float amount, float normal) {
    const auto kernel = bound(
        {.base = 0.0f, .roughness = 0.0f, .extras = {.reflectance = reflectance(amount, normal)}});
    return test::sampled_albedo(kernel, wo, 20'000);
  };
  for (const auto& [amount, normal] : {std::pair{1.0f, 0.2f}, {0.5f, 0.04f}, {0.5f, 0.9f}}) {
    const auto mean = of(amount, normal);
    EXPECT_NEAR(mean.value, static_cast<double>(amount * normal), 4.5 * mean.standard_error + 1e-5);
  }
}

// Along the index's own reflectance nothing changes.
TEST(Principled, TheIndexsOwnReflectanceIsTheDefault) {
  const auto plain = bound({.roughness = 0.4f});
  const auto same = bound({.roughness = 0.4f, .extras = {.reflectance = reflectance(1.0f, 0.04f)}});
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto u = test::numbers(i, 5);
    const Vec3 wo = UniformHemisphere::sample(u[0], u[1]),
               wi = UniformHemisphere::sample(u[2], u[3]);
    EXPECT_NEAR(plain.value(wo, wi)[0], same.value(wo, wi)[0], 1e-4f * plain.value(wo, wi)[0]);
  }
}

// White fuzz over black reflects what its table says, or all.
TEST(Principled, FuzzReflectsItsAlbedo) {
  for (const float roughness : {0.1f, 0.4f, 0.8f, 1.0f}) {
    for (const double degrees : {20.0, 60.0, 80.0}) {
      const Vec3 wo = test::direction(degrees);
      const float alpha = std::max(SheenEnergy::kMinAlpha, roughness * roughness);
      const auto mean = test::mean_of(40'000, [&](std::uint32_t i) {
        const auto u = test::numbers(i, 9);
        const Vec3 wi = UniformHemisphere::sample(u[0], u[1]);
        return static_cast<double>(SheenEnergy::value(wo, wi, half_vector(wo, wi), alpha) /
                                   UniformHemisphere::pdf(wi));
      });
      EXPECT_NEAR(mean.value, static_cast<double>(SheenEnergy::instance().reflected(wo.z, alpha)),
                  4.5 * mean.standard_error + 0.005)
          << roughness << " " << degrees;
    }
  }
}

// Turned by a quarter, along is across.
TEST(Principled, ABrushTurns) {
  const auto turned = bound({.roughness = 0.2f, .extras = {.brush = brush(0.6f, 0.25f)}});
  const auto swapped = bound({.roughness = 0.6f, .extras = {.brush = brush(0.2f, 0.0f)}});
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto u = test::numbers(i, 6);
    const Vec3 wo = UniformHemisphere::sample(u[0], u[1]),
               wi = UniformHemisphere::sample(u[2], u[3]);
    EXPECT_NEAR(turned.value(wo, wi)[0], swapped.value(wo, wi)[0],
                1e-3f * turned.value(wo, wi)[0] + 1e-6f);
  }
}

TEST(Principled, ExtrasAreReciprocal) {
  for (const float metallic : {0.0f, 0.3f, 1.0f}) {
    const auto kernel = bound({.metallic = metallic,
                               .roughness = 0.4f,
                               .coat = 0.5f,
                               .coat_roughness = 0.3f,
                               .extras = {.reflectance = reflectance(0.8f, 0.3f),
                                          .brush = brush(0.7f, 0.15f),
                                          .sheen = fuzz(0.8f, 0.4f)}});
    EXPECT_LT(test::largest_asymmetry(kernel), 2e-4f);
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

#include "kernels/conductor.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

using test::direction;

// n = 0: reflects everything at every angle.
Conductor perfect(float u, float v) {
  return {Spectrum(0.0f), Spectrum(1.0f), {Scalar(u), Scalar(v)}};
}

BoundConductor<1> bound(const Conductor& kernel) {
  return kernel.bind(Shading<1>{.wavelengths = 550.0f});
}

// Directional albedo of single scattering with F = 1 and height-correlated G2 (Heitz 2014; 1 - ln 2
// at alpha 1 and normal incidence), known to 6e-6.
TEST(Conductor, FurnaceIsAsPublished) {
  struct Case {
    float alpha;
    std::array<double, 4> albedo;
  };
  constexpr std::array<double, 4> kCosines{1.0, 0.7, 0.5, 0.2};
  const Case cases[]{{0.1f, {0.98830419, 0.98141853, 0.96920501, 0.90455907}},
                     {0.25f, {0.91581396, 0.88533576, 0.85726346, 0.84815992}},
                     {0.5f, {0.68784825, 0.68295422, 0.69825069, 0.78992919}},
                     {1.0f, {0.30685191, 0.37888775, 0.45069387, 0.64164812}}};
  for (const Case& c : cases) {
    for (std::size_t i = 0; i < kCosines.size(); ++i) {
      const Vec3 wo = direction(std::acos(kCosines[i]) * 180.0 / std::numbers::pi);
      const auto kernel = bound(perfect(c.alpha, c.alpha));
      const auto mean = test::sampled_albedo(kernel, wo, 100'000);
      // 16 comparisons: one false alarm in 1,000 runs of other seeds.
      EXPECT_NEAR(mean.value, c.albedo[i], 4.0 * mean.standard_error + 6e-6)
          << c.alpha << " " << kCosines[i];
    }
  }
}

TEST(Conductor, DrawsWeighAtMostFresnel) {
  for (const float alpha : {1e-4f, 0.01f, 0.3f, 1.0f}) {
    const auto kernel = bound(perfect(alpha, alpha));
    for (const double degrees : {0.0, 60.0, 89.9, 89.9999}) {
      for (std::uint32_t i = 0; i < 2000; ++i) {
        const double w =
            test::weight(kernel, direction(degrees), test::kernel_numbers(test::numbers(i, 5)));
        ASSERT_GE(w, 0.0);
        ASSERT_LE(w, 1.0 + 1e-6);
      }
    }
  }
}

// With masking alone every facet that is seen sends on all that it gets.
void expect_weak_furnace(FacetDistribution distribution) {
  for (const auto& [u, v] : {std::pair{0.3f, 0.3f}, {1.0f, 1.0f}, {0.1f, 0.7f}}) {
    const Facets facets{u, v, distribution};
    for (const double degrees : {0.0, 50.0, 85.0}) {
      const Vec3 wo = direction(degrees, 30.0);
      // Integral of D_wo/(4 wo.h) over all wi, by uniform directions.
      const auto mean = test::mean_of(400'000, [&](std::uint32_t i) {
        const auto u4 = test::numbers(i, 8);
        const Vec3 wi = UniformSphere::sample(u4[0], u4[1]);
        const Vec3 sum = wo + wi;
        if (sum.z <= 0.0f || dot(wo, wi) <= -0.999999f) return 0.0;
        return static_cast<double>(facets.reflection_pdf(wo, normalized(sum)) /
                                   UniformSphere::pdf());
      });
      // 1e-7: at roughness 1 the density is the same everywhere, and only rounding is left.
      EXPECT_NEAR(mean.value, 1.0, 4.0 * mean.standard_error + 1e-7)
          << u << " " << v << " " << degrees;
    }
  }
}
TEST(Conductor, WeakFurnaceIsOne) { expect_weak_furnace(FacetDistribution::kGgx); }
TEST(Conductor, WeakFurnaceOfBeckmannIsOne) { expect_weak_furnace(FacetDistribution::kBeckmann); }

TEST(Conductor, MirrorReflectsByFresnel) {
  const auto kernel = bound({Spectrum(0.18344f), Spectrum(3.4332f), {Scalar(0.0f), Scalar(5e-5f)}});
  EXPECT_FALSE(kernel.smooth());
  const Vec3 wo = direction(60.0, 20.0);
  const auto draw = kernel.sample(wo, {0.3f, 0.4f, 0.5f}, 0);
  ASSERT_TRUE(draw && draw->delta);
  EXPECT_EQ(draw->wi.x, -wo.x);
  EXPECT_EQ(draw->wi.y, -wo.y);
  EXPECT_EQ(draw->wi.z, wo.z);
  EXPECT_NEAR(draw->factor[0], 0.93880841, 1e-6);
}

TEST(Conductor, NearlySmoothIsTheMirror) {
  const Conductor gold{Spectrum(0.18344f), Spectrum(3.4332f), {Scalar(1e-4f), Scalar(1e-4f)}};
  const auto mean = test::sampled_albedo(bound(gold), direction(60.0), 20'000);
  EXPECT_NEAR(mean.value, 0.93880841, 1e-4);
}

TEST(Conductor, IndexIsRelativeToOutside) {
  const Conductor metal{Spectrum(3.0f), Spectrum(4.5f), {Scalar(0.0f), Scalar(0.0f)}};
  const auto kernel = metal.bind(Shading<1>{.wavelengths = 550.0f, .index_from = 1.5f});
  const auto draw = kernel.sample({0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}, 0);
  EXPECT_NEAR(draw->factor[0], fresnel_conductor(1.0, 2.0, 3.0), 1e-6);
}

}  // namespace
}  // namespace nocturne

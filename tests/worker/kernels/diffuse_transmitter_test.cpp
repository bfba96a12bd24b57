#include "kernels/diffuse_transmitter.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

Spectrum line(float blue, float red) { return {400.0f, 300.0f, {blue, red}, false}; }

Shading<4> shading() { return {.wavelengths = test::lanes(400.0f, 500.0f, 600.0f, 700.0f)}; }

TEST(DiffuseTransmitter, EachSideFollowsLambertsLaw) {
  const DiffuseTransmitter sheet(Colour(line(0.2f, 0.5f)), Colour(line(0.6f, 0.3f)));
  const auto kernel = sheet.bind(shading());
  const Vec3 wo = test::direction(50.0, 10.0);
  for (const double degrees : {0.0, 30.0, 89.0}) {
    const Vec3 up = test::direction(degrees, 200.0), down{up.x, up.y, -up.z};
    for (std::size_t i = 0; i < 4; ++i) {
      const float share = static_cast<float>(i) / 3.0f;
      EXPECT_NEAR(kernel.value(wo, up)[i], (0.2f + 0.3f * share) * kInvPi * up.z, 1e-6);
      EXPECT_NEAR(kernel.value(wo, down)[i], (0.6f - 0.3f * share) * kInvPi * up.z, 1e-6);
    }
  }
  EXPECT_TRUE(kernel.smooth());
  EXPECT_TRUE(kernel.transmits());
}

// Samples carry reflectance to one side and transmittance to the other, at every wavelength though
// one probability serves all, and the cosine of drawn directions has a cosine's mean, 2/3.
TEST(DiffuseTransmitter, DrawsCarryBothShares) {
  const DiffuseTransmitter sheet(Colour(line(0.0f, 0.5f)), Colour(line(1.0f, 0.3f)));
  const auto kernel = sheet.bind(shading());
  const Vec3 wo = test::direction(70.0);
  constexpr std::uint32_t kDraws = 50'000;
  const double reflectance[]{0.0, 0.5 / 3.0, 1.0 / 3.0, 0.5};
  for (std::size_t lane = 0; lane < 4; ++lane) {
    EXPECT_NEAR(kernel.albedo(wo)[lane], 1.0 - 0.2 * static_cast<double>(lane) / 3.0, 1e-6);
    for (const bool back : {true, false}) {
      const auto mean = test::mean_of(kDraws, [&](std::uint32_t i) {
        const auto u = test::kernel_numbers(test::numbers(i, 2));
        return (kernel.sample(wo, u, 0)->wi.z > 0.0f) == back ? test::weight(kernel, wo, u, lane)
                                                              : 0.0;
      });
      const double all = 1.0 - 0.2 * static_cast<double>(lane) / 3.0;
      // 8 comparisons: one false alarm in 2,000 sets of other seeds. 1e-6: rounding where every
      // draw weighs the same.
      EXPECT_NEAR(mean.value, back ? reflectance[lane] : all - reflectance[lane],
                  4.0 * mean.standard_error + 1e-6);
    }
  }
  const auto cosine = test::mean_of(kDraws, [&](std::uint32_t i) {
    const auto draw = kernel.sample(wo, test::kernel_numbers(test::numbers(i, 3)), 0);
    EXPECT_EQ(draw->coherent, 15u);
    return std::fabs(static_cast<double>(draw->wi.z));
  });
  EXPECT_NEAR(cosine.value, 2.0 / 3.0, 4.0 * cosine.standard_error);
}

TEST(DiffuseTransmitter, OneSidedAndBlackSheetsAreSound) {
  const Vec3 wo = test::direction(20.0);
  const auto mean = [&](float reflectance, float transmittance) {
    const DiffuseTransmitter sheet{Colour(Spectrum(reflectance)), Colour(Spectrum(transmittance))};
    return test::sampled_albedo(sheet.bind(Shading<1>{.wavelengths = 550.0f}), wo, 1000);
  };
  EXPECT_NEAR(mean(0.7f, 0.0f).value, 0.7, 1e-6);
  EXPECT_NEAR(mean(0.0f, 0.7f).value, 0.7, 1e-6);
  EXPECT_EQ(mean(0.0f, 0.0f).value, 0.0);
}

}  // namespace
}  // namespace nocturne

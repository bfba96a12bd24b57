#include "kernels/phong.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

// (n + 2) times the integral of cos^(n+1) is 1. Simpson's rule over the lobe's own width, in
// double.
TEST(Phong, AlbedoAtNormalIncidenceIsOne) {
  for (const double n : {10.0, 1000.0, 1e5, 1e6}) {
    constexpr int kSteps = 200'000;
    const double width = std::min(1.0, 40.0 / n);
    const auto f = [&](double less) { return (n + 2.0) * phong_lobe(n, less) * (1.0 - less); };
    double sum = f(0.0) + f(width);
    for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(width * i / kSteps);
    EXPECT_NEAR(sum * width / (3.0 * kSteps), 1.0, 1e-12) << n;
  }
}

TEST(Phong, DrawsGiveTheAlbedo) {
  for (const float n : {0.0f, 10.0f, 1000.0f, 1e5f}) {
    const Phong phong{Colour(Spectrum(0.8f)), n};
    const auto kernel = phong.bind(Shading<1>{.wavelengths = 550.0f});
    const auto mean = test::sampled_albedo(kernel, {0.0f, 0.0f, 1.0f}, 100'000);
    EXPECT_NEAR(mean.value, 0.8, 4.0 * mean.standard_error + 1e-6) << n;
    EXPECT_EQ(kernel.albedo({0.0f, 0.0f, 1.0f})[0], 0.8f);
  }
}

TEST(Phong, IsReciprocal) {
  for (const float n : {0.0f, 10.0f, 1000.0f}) {
    const Phong phong{Colour(Spectrum(0.8f)), n};
    const auto kernel = phong.bind(Shading<1>{.wavelengths = 550.0f});
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const auto u = test::numbers(i, 31);
      const Vec3 a = UniformHemisphere::sample(u[0], u[1]);
      // Half of the pairs within the lobe.
      const Vec3 b = i % 2 == 0
                         ? UniformHemisphere::sample(u[2], u[3])
                         : normalized(Vec3{-a.x, -a.y, a.z} + 0.05f * Vec3{u[2], u[3], u[2]});
      const float f = kernel.value(a, b)[0] / b.z;
      EXPECT_NEAR(kernel.value(b, a)[0] / a.z, f, 1e-4f * f + 1e-12f) << n;
    }
  }
}

}  // namespace
}  // namespace nocturne

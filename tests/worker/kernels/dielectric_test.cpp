#include "kernels/dielectric.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

using test::direction;

template <int N>
BoundDielectric<N> bound(float alpha, Spectral<N> from, Spectral<N> to,
                         Transport transport = Transport::kAdjoint) {
  return Dielectric{{Scalar(alpha), Scalar(alpha)}}.bind(Shading<N>{
      .wavelengths = 550.0f, .index_from = from, .index_to = to, .transport = transport});
}

TEST(Dielectric, SmoothRefractsBySnell) {
  const auto kernel = bound<1>(0.0f, 1.0f, 1.5f);
  const Vec3 wo = direction(40.0, 25.0);
  const auto in = kernel.sample(wo, {0.9f, 0.0f, 0.0f}, 0);
  ASSERT_TRUE(in && in->delta);
  EXPECT_NEAR(in->wi.x, -wo.x / 1.5f, 1e-6);
  EXPECT_NEAR(in->wi.y, -wo.y / 1.5f, 1e-6);
  EXPECT_LT(in->wi.z, 0.0f);
  EXPECT_FLOAT_EQ(in->factor[0], 1.0f / 2.25f);
  EXPECT_EQ(bound<1>(0.0f, 1.0f, 1.5f, Transport::kForward).sample(wo, {0.9f, 0, 0}, 0)->factor[0],
            1.0f);
  const auto trapped = bound<1>(0.0f, 1.5f, 1.0f).sample(direction(42.0), {0.9999f, 0, 0}, 0);
  EXPECT_GT(trapped->wi.z, 0.0f);
}

// By Fresnel's equations at 40 degrees, 4.6 % of the photons are mirrored by chance. Half of them
// with less weight have the same mean; with the root of that, the mean square that those by chance
// have.
TEST(Dielectric, MirrorsHalfWithTheMeanOrTheMeanSquareOfChance) {
  using Halves = KernelNumbers::Halves;
  const auto kernel =
      bound<4>(0.0f, 1.0f, test::lanes(1.5f, 1.6f, 1.5f, 1.7f), Transport::kForward);
  const Vec3 wo = direction(40.0);
  for (std::size_t lane : {0u, 1u, 3u}) {
    const float ratio = kernel.ratio[lane];
    const float mirrored = fresnel_dielectric<float>(wo.z, ratio);
    for (const Halves halves : {Halves::kYes, Halves::kOfSquare}) {
      const auto back = kernel.sample(wo, {0.49f, 0.0f, 0.0f, halves}, lane);
      const auto in = kernel.sample(wo, {0.51f, 0.0f, 0.0f, halves}, lane);
      ASSERT_TRUE(back && in && back->delta && in->delta);
      EXPECT_GT(back->wi.z, 0.0f);
      EXPECT_LT(in->wi.z, 0.0f);
      const auto weight = [&](const Draw<4>& draw) {
        const float factor = draw.factor[lane];
        return 0.5f * (halves == Halves::kYes ? factor : factor * factor);
      };
      EXPECT_NEAR(weight(*back), mirrored, 1e-5f);
      EXPECT_NEAR(weight(*in), 1.0f - mirrored, 1e-5f);
    }
  }
  // Total reflection is not halved.
  const auto inside = bound<1>(0.0f, 1.5f, 1.0f);
  const auto total = inside.sample(direction(60.0), {0.9f, 0.0f, 0.0f, Halves::kYes}, 0);
  EXPECT_GT(total->wi.z, 0.0f);
  EXPECT_EQ(total->factor[0], 1.0f);
}

TEST(Dielectric, EqualIndicesAreInvisible) {
  for (const float alpha : {0.0f, 0.3f}) {
    const auto kernel = bound<4>(alpha, 1.37f, 1.37f);
    EXPECT_FALSE(kernel.smooth());
    const Vec3 wo = direction(77.0, 12.0);
    const auto draw = kernel.sample(wo, {0.0f, 0.3f, 0.6f}, 1);
    EXPECT_TRUE(draw->delta);
    EXPECT_EQ(draw->coherent, 15u);
    EXPECT_EQ(draw->wi.x, -wo.x);
    EXPECT_EQ(draw->wi.y, -wo.y);
    EXPECT_EQ(draw->wi.z, -wo.z);
    EXPECT_EQ(draw->factor[0], 1.0f);
  }
}

TEST(Dielectric, RefractionPartsAndReflectionDoesNot) {
  const Spectral<4> to = test::lanes(1.5f, 1.51f, 1.5f, 1.52f);
  for (const float alpha : {0.0f, 0.2f}) {
    const auto kernel = bound<4>(alpha, 1.0f, to);
    const Vec3 wo = direction(30.0);
    EXPECT_EQ(kernel.sample(wo, {0.9f, 0.2f, 0.3f}, 0)->coherent, 0b0101u);
    EXPECT_EQ(kernel.sample(wo, {0.9f, 0.2f, 0.3f}, 3)->coherent, 0b1000u);
    EXPECT_EQ(kernel.sample(wo, {0.001f, 0.2f, 0.3f}, 0)->coherent, 0b1111u);
  }
}

// f(wo, wi) n_wi^2 is symmetric for radiance: Veach 1997, equation 5.14.
TEST(Dielectric, IsReciprocalUpToTheIndexSquared) {
  const float n = 1.5f;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const auto u = test::numbers(i, 31);
    const Vec3 a = UniformHemisphere::sample(u[0], u[1]), b = UniformHemisphere::sample(u[2], u[3]);
    const auto above = bound<1>(0.4f, 1.0f, n), below = bound<1>(0.4f, n, 1.0f);
    // Seen from the other side, z is turned round.
    const Vec3 down{b.x, b.y, -b.z}, up{a.x, a.y, -a.z};
    const double there = static_cast<double>(above.value(a, down)[0] / b.z);
    const double back = static_cast<double>(below.value(b, up)[0] / a.z);
    EXPECT_NEAR(there * static_cast<double>(n * n), back, 2e-3 * std::max(1e-3, back));
    const double f = static_cast<double>(above.value(a, b)[0] / b.z);
    EXPECT_NEAR(f, static_cast<double>(above.value(b, a)[0] / a.z), 1e-4 * std::max(1e-3, f));
  }
}

// What single scattering sends back and through, for a flux of 1. All digits from an independent
// evaluation: quadrature over facet slopes in double, Walter's equations 20, 21, 33 and 34, with
// the height-correlated G2 of ggx.h; known to 2e-5.
TEST(Dielectric, ForwardLosesOnlyToMasking) {
  struct Case {
    float alpha;
    double degrees;
    float ratio;
    double reflected, transmitted;
  };
  const Case cases[]{
      {0.1f, 0.0, 1.5f, 0.039637, 0.959198},  {0.1f, 0.0, 1.0f / 1.5f, 0.042544, 0.946418},
      {0.1f, 60.0, 1.5f, 0.085882, 0.906348}, {0.1f, 60.0, 1.0f / 1.5f, 0.940338, 0.023025},
      {0.1f, 85.0, 1.5f, 0.321917, 0.597517}, {0.1f, 85.0, 1.0f / 1.5f, 0.858463, 0.004909},
      {0.5f, 0.0, 1.5f, 0.028175, 0.939932},  {0.5f, 0.0, 1.0f / 1.5f, 0.046165, 0.707699},
      {0.5f, 60.0, 1.5f, 0.043935, 0.832974}, {0.5f, 60.0, 1.0f / 1.5f, 0.434484, 0.210525},
      {0.5f, 85.0, 1.5f, 0.103110, 0.451860}, {0.5f, 85.0, 1.0f / 1.5f, 0.658734, 0.003418}};
  for (const Case& c : cases) {
    const auto kernel = bound<1>(c.alpha, 1.0f, c.ratio, Transport::kForward);
    const Vec3 wo = direction(c.degrees);
    for (const bool back : {true, false}) {
      const auto mean = test::mean_of(40'000, [&](std::uint32_t i) {
        const auto u = test::kernel_numbers(test::numbers(i, 1));
        const auto draw = kernel.sample(wo, u, 0);
        const bool counts = draw && !draw->delta && (draw->wi.z > 0.0f) == back;
        return counts ? test::weight(kernel, wo, u) : 0.0;
      });
      // 24 comparisons: one false alarm in 650 sets of other seeds.
      EXPECT_NEAR(mean.value, back ? c.reflected : c.transmitted, 4.0 * mean.standard_error + 2e-5)
          << c.alpha << " " << c.degrees << " " << c.ratio << " " << back;
    }
  }
}

TEST(Dielectric, NearlySmoothLosesNothing) {
  for (const double degrees : {0.0, 60.0, 85.0}) {
    for (const float n : {1.5f, 1.0f / 1.5f}) {
      const auto mean = test::sampled_albedo(bound<1>(1e-4f, 1.0f, n, Transport::kForward),
                                             direction(degrees), 20'000);
      EXPECT_NEAR(mean.value, 1.0, 1e-3) << degrees << " " << n;
    }
  }
}

}  // namespace
}  // namespace nocturne

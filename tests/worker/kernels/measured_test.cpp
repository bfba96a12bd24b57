#include <gtest/gtest.h>

#include "kernel_checks.h"
#include "measured_blob.h"

namespace nocturne {
namespace {

using test::MeasuredBlob;

TEST(Measured, ConstantTableIsLambertian) {
  MeasuredBlob blob;
  blob.f = [](double, double, double, std::uint32_t) { return 0.5 / std::numbers::pi; };
  const auto measured = blob.kernel();
  const auto kernel = measured.bind(Shading<1>{.wavelengths = 550.0f});
  for (const double degrees : {0.0, 45.0, 89.0}) {
    const Vec3 wo = test::direction(degrees), wi = test::direction(30.0, 200.0);
    EXPECT_NEAR(kernel.value(wo, wi)[0], 0.5f * kInvPi * wi.z, 1e-6);
    const auto mean = test::sampled_albedo(kernel, wo, 100'000);
    EXPECT_NEAR(mean.value, 0.5, 4.0 * mean.standard_error);
    EXPECT_NEAR(kernel.albedo(wo)[0], 0.5, 0.03);
  }
}

// At its nodes the table returns the stored values.
TEST(Measured, AnglesAreRusinkiewiczs) {
  MeasuredBlob blob;
  blob.n_phi_d = 180;
  blob.f = [](double h, double d, double p, std::uint32_t) {
    return 0.5 + h + 0.3 * d + 0.2 * std::cos(2.0 * p) + 0.1 * std::sin(2.0 * p);
  };
  const auto measured = blob.kernel();
  const auto kernel = measured.bind(Shading<1>{.wavelengths = 550.0f});
  for (std::uint32_t i = 0; i < 500; ++i) {
    const auto u = test::numbers(i, 21);
    // From half-angle coordinates to directions, in double.
    const double h = 1.2 * static_cast<double>(u[0]), d = 1.2 * static_cast<double>(u[1]);
    const double p = std::numbers::pi * static_cast<double>(u[2]);
    const double azimuth = 6.0 * static_cast<double>(u[3]);
    const auto turned = [&](double sign) {
      const double x = sign * std::sin(d) * std::cos(p), y = sign * std::sin(d) * std::sin(p),
                   z = std::cos(d);
      const double a = x * std::cos(h) + z * std::sin(h), c = z * std::cos(h) - x * std::sin(h);
      return Vec3{static_cast<float>(a * std::cos(azimuth) - y * std::sin(azimuth)),
                  static_cast<float>(a * std::sin(azimuth) + y * std::cos(azimuth)),
                  static_cast<float>(c)};
    };
    const Vec3 wi = turned(1.0), wo = turned(-1.0);
    if (wi.z < 0.05f || wo.z < 0.05f) continue;
    // Linear interpolation of these functions is within 5e-3: steps of a degree, and of up to 2 %
    // of a right angle in theta_h.
    EXPECT_NEAR(kernel.value(wo, wi)[0] / wi.z, blob.f(h, d, p, 0), 5e-3);
    EXPECT_NEAR(kernel.value(wi, wo)[0] / wo.z, kernel.value(wo, wi)[0] / wi.z, 1e-3);
  }
}

TEST(Measured, IsReciprocal) {
  MeasuredBlob blob;
  blob.n_phi_d = 180;
  blob.f = [](double h, double d, double p, std::uint32_t) {
    return (0.05 + 20.0 * std::exp(-std::pow(h / 0.1, 2))) * (1.0 + d) *
           (1.5 + std::cos(2.0 * p + 1.0));
  };
  const auto measured = blob.kernel();
  const auto kernel = measured.bind(Shading<1>{.wavelengths = 550.0f});
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const auto u = test::numbers(i, 31);
    const Vec3 a = UniformHemisphere::sample(u[0], u[1]);
    const Vec3 b = i % 2 == 0 ? UniformHemisphere::sample(u[2], u[3])
                              : normalized(Vec3{-a.x, -a.y, a.z} + 0.2f * Vec3{u[2], u[3], u[2]});
    // phi_d turns by pi, which single precision knows to 1e-7 over the tilt of half vector and wi.
    const float f = kernel.value(a, b)[0] / b.z;
    EXPECT_NEAR(kernel.value(b, a)[0] / a.z, f, 1e-3f * f) << i;
  }
}

// Phong's lobe as a table, at normal incidence. There the angle to the mirror direction is twice
// theta_h whatever theta_d is, so that the table's own error is that of linear interpolation in one
// variable, which a sum in double gives without any noise; the lobe itself has albedo 1.
TEST(Measured, PhongLobeFromATable) {
  struct Case {
    double exponent, interpolation_error;
  };
  for (const Case& c : {Case{10.0, 5.66e-4}, Case{1000.0, 7.7e-3}}) {
    const auto lobe = [&](double cosine) {
      return cosine > 0.0
                 ? (c.exponent + 2.0) / (2.0 * std::numbers::pi) * std::pow(cosine, c.exponent)
                 : 0.0;
    };
    MeasuredBlob blob;
    blob.n_phi_d = 180;
    blob.f = [&](double h, double d, double p, std::uint32_t) {
      const double x = std::sin(h) * std::sin(d) * std::cos(p), z = std::cos(h) * std::cos(d);
      return lobe(2.0 * (z * z - x * x) - std::cos(2.0 * d));
    };
    const auto node = [&](double i) {
      const double x = i / blob.n_theta_h;
      return lobe(std::cos(std::numbers::pi * x * x));
    };
    const auto measured = blob.kernel();
    const auto kernel = measured.bind(Shading<1>{.wavelengths = 550.0f});
    double of_kernel = 0.0, linear = 0.0;
    constexpr int kSteps = 20'000;
    for (int i = 0; i < kSteps; ++i) {
      const double theta = 0.5 * std::numbers::pi * (i + 0.5) / kSteps;
      const double ring =
          2.0 * std::numbers::pi * std::sin(theta) * 0.5 * std::numbers::pi / kSteps;
      const Vec3 wi{static_cast<float>(std::sin(theta)), 0.0f, static_cast<float>(std::cos(theta))};
      of_kernel += static_cast<double>(kernel.value({0.0f, 0.0f, 1.0f}, wi)[0]) * ring;
      const double x = std::sqrt(theta / std::numbers::pi) * blob.n_theta_h, low = std::floor(x);
      linear += (node(low) + (x - low) * (node(low + 1.0) - node(low))) * std::cos(theta) * ring;
    }
    EXPECT_NEAR(of_kernel, linear, 1e-5) << c.exponent;
    EXPECT_NEAR(linear - 1.0, c.interpolation_error, 0.02 * c.interpolation_error) << c.exponent;
    // Draws agree with the table's integral, not with the lobe's.
    const auto mean = test::sampled_albedo(kernel, {0.0f, 0.0f, 1.0f}, 100'000);
    EXPECT_NEAR(mean.value, linear, 4.0 * mean.standard_error) << c.exponent;
  }
}

TEST(Measured, WavelengthsAreInterpolated) {
  const auto measured = test::glossy_blob().kernel();
  const auto kernel =
      measured.bind(Shading<4>{.wavelengths = test::lanes(400.0f, 550.0f, 700.0f, 900.0f)});
  const auto v = kernel.value({0.0f, 0.0f, 1.0f}, test::direction(70.0));
  EXPECT_FLOAT_EQ(v[2], 0.5f * v[0]);
  EXPECT_FLOAT_EQ(v[1], 0.75f * v[0]);
  EXPECT_EQ(v[3], v[2]);
}

TEST(Measured, PlanesMayWeighBasisSpectra) {
  MeasuredBlob blob;
  blob.n_planes = 3;
  blob.n_basis = 2;
  blob.basis = {1.0f, 0.0f, 0.0f, 0.0f, 0.5f, 0.5f};
  blob.f = [](double, double, double, std::uint32_t plane) { return 0.1 * (plane + 1); };
  const auto measured = blob.kernel();
  const auto kernel =
      measured.bind(Shading<4>{.wavelengths = test::lanes(400.0f, 550.0f, 700.0f, 300.0f)});
  const auto v = kernel.value({0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 1.0f});
  EXPECT_NEAR(v[0], 0.1, 1e-6);
  EXPECT_NEAR(v[1], 0.175, 1e-6);
  EXPECT_NEAR(v[2], 0.25, 1e-6);
  EXPECT_NEAR(v[3], 0.1, 1e-6);
}

// Even light along the normal comes from a diffuse surface with the cosine, sin^2 of the angle up
// to it, and is turned by twice the half vector's. A lobe of exp(-tan^2/a^2) / cos^4 has 1 -
// exp(-1) within the slope a (Beckmann), and its light along the normal as good as that while it is
// narrow.
TEST(Measured, TellsHowMuchStaysTogether) {
  test::MeasuredBlob blob;
  blob.f = [](double, double, double, std::uint32_t) { return 0.3; };
  for (const double slope : {0.1, 0.3, 0.8}) {
    const double sine = std::sin(2.0 * std::atan(slope));
    EXPECT_NEAR(blob.kernel().table->share_within(slope), sine * sine, 2e-3) << slope;
  }
  blob.f = [](double theta_h, double, double, std::uint32_t) {
    const double slope = std::tan(theta_h) / 0.05, cosine = std::cos(theta_h);
    return std::exp(-slope * slope) / (cosine * cosine * cosine * cosine);
  };
  EXPECT_NEAR(blob.kernel().table->share_within(0.05), 1.0 - std::exp(-1.0), 0.01);
  blob.f = [](double, double, double, std::uint32_t) { return 0.0; };
  EXPECT_EQ(blob.kernel().table->share_within(0.3), 0.0);
}

TEST(Measured, RefusesWhatIsDamaged) {
  const auto good = test::glossy_blob();
  EXPECT_NO_THROW(MeasuredTable{good.bytes()});
  const auto refused = [](const std::vector<std::byte>& bytes) {
    EXPECT_THROW(MeasuredTable{bytes}, std::invalid_argument);
  };
  auto bytes = good.bytes();
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{7}, std::size_t{39}, bytes.size() - 1}) {
    refused({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
  }
  bytes.push_back(std::byte{0});
  refused(bytes);
  bytes = good.bytes();
  bytes[0] = std::byte{'X'};
  refused(bytes);
  for (const float bad : {-1e-3f, std::nanf(""), HUGE_VALF}) {
    bytes = good.bytes();
    std::memcpy(&bytes[4000], &bad, 4);
    refused(bytes);
  }
  for (std::size_t field = 8; field < 32; field += 4) {
    for (const std::uint32_t bad : {0u, 4096u, 0xFFFFFFFFu}) {
      if (field == 28 && bad == 0u) continue;  // no basis: as it is
      bytes = good.bytes();
      std::memcpy(&bytes[field], &bad, 4);
      refused(bytes);
    }
  }
}

}  // namespace
}  // namespace nocturne

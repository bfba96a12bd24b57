#include "kernels/fresnel.h"

#include <gtest/gtest.h>

#include <array>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

namespace nocturne {
namespace {

double cos_degrees(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

struct At {
  double degrees, reflectance;
};

// 2 x the integral of r(mu) mu: Simpson's rule in x, mu = x^3, which takes care of grazing angles.
double hemispherical(const std::function<double(double)>& r) {
  constexpr int kSteps = 20'000;
  const auto f = [&](double x) { return 6.0 * r(x * x * x) * std::pow(x, 5); };
  double sum = f(0.0) + f(1.0);
  for (int i = 1; i < kSteps; ++i)
    sum += (i % 2 == 1 ? 4.0 : 2.0) * f(static_cast<double>(i) / kSteps);
  return sum / (3.0 * kSteps);
}

struct Glass {
  double n;
  std::vector<At> at;
  double outside, inside, brewster, critical;
};

// Unpolarised Fresnel reflectance; hemispherical: Stern, Applied Optics 3(1), 1964 publishes 0.0918
// and 0.5963 for 1.5. All digits from an independent evaluation.
const std::vector<Glass> kGlasses{
    {1.3333,
     {{0, 0.020404665},
      {30, 0.021468953},
      {45, 0.027936124},
      {60, 0.059747378},
      {75, 0.21247213},
      {85, 0.58360228},
      {89, 0.89629915}},
     0.066453209,
     0.47485367,
     53.129415,
     48.592002},
    {1.5,
     {{0, 0.04},
      {30, 0.041522626},
      {45, 0.050239911},
      {60, 0.089186713},
      {75, 0.25306056},
      {85, 0.61279965},
      {89, 0.90418495}},
     0.091777959,
     0.59634576,
     56.309932,
     41.810315},
    {1.0001,
     {{0, 2.49975e-09},
      {30, 2.777426e-09},
      {45, 4.9985005e-09},
      {60, 2.4979514e-08},
      {75, 4.8599428e-07},
      {85, 4.1571166e-05},
      {89, 0.015746749}},
     3.3291731e-05,
     0.00023325508,
     45.002865,
     89.189749},
    {4.0,
     {{0, 0.36},
      {30, 0.35976998},
      {45, 0.35882865},
      {60, 0.35791197},
      {75, 0.38331801},
      {85, 0.56770703},
      {89, 0.86561395}},
     0.36663806,
     0.96041488,
     75.963757,
     14.477512},
    {2.4175,
     {{10, 0.17205607},
      {40, 0.17733776},
      {56, 0.19911169},
      {70, 0.27067535},
      {80, 0.43331683},
      {89.9, 0.98923306}},
     0.21224647,
     0.86521009,
     67.527544,
     24.434359},
};

TEST(FresnelDielectric, IsAsPublished) {
  for (const Glass& glass : kGlasses) {
    SCOPED_TRACE(glass.n);
    for (const At& at : glass.at) {
      EXPECT_NEAR(fresnel_dielectric(cos_degrees(at.degrees), glass.n), at.reflectance,
                  3e-8 * at.reflectance)
          << at.degrees;
    }
  }
}

TEST(FresnelDielectric, HemisphericalIsAsPublishedAndTheIntegral) {
  for (const Glass& glass : kGlasses) {
    SCOPED_TRACE(glass.n);
    EXPECT_NEAR(hemispherical_reflectance(glass.n), glass.outside, 3e-7 * glass.outside);
    EXPECT_NEAR(hemispherical_reflectance(1.0 / glass.n), glass.inside, 3e-7 * glass.inside);
    EXPECT_NEAR(hemispherical([&](double c) { return fresnel_dielectric(c, glass.n); }),
                glass.outside, 1e-6 * glass.outside);
  }
}

// Of both sides, from a film that hardly differs to more than any material has.
TEST(FresnelDielectric, HemisphericalByTableIsTheClosedForm) {
  const HemisphericalReflectance& table = HemisphericalReflectance::instance();
  EXPECT_EQ(table(1.0f), 0.0f);
  for (int i = 0; i < 200000; ++i) {
    const double more = 1e-7 * std::pow(5e7, i / 199999.0);
    for (const float ratio :
         {static_cast<float>(1.0 + more), static_cast<float>(1.0 / (1.0 + more))}) {
      ASSERT_NEAR(table(ratio), hemispherical_reflectance(ratio), 1e-6) << ratio;
    }
  }
}

TEST(FresnelDielectric, BrewsterAndCriticalAngles) {
  for (const Glass& glass : kGlasses) {
    SCOPED_TRACE(glass.n);
    // At Brewster's angle only s is left, whose amplitude is (n^2 - 1) / (n^2 + 1).
    const double n2 = glass.n * glass.n, s = (n2 - 1.0) / (n2 + 1.0);
    EXPECT_NEAR(fresnel_dielectric(cos_degrees(glass.brewster), glass.n), 0.5 * s * s,
                1e-7 * s * s);
    const double degree = 1e-5;
    EXPECT_EQ(fresnel_dielectric(cos_degrees(glass.critical + degree), 1.0 / glass.n), 1.0);
    EXPECT_LT(fresnel_dielectric(cos_degrees(glass.critical - degree), 1.0 / glass.n), 1.0);
  }
}

TEST(FresnelDielectric, IsTheSameFromBothSides) {
  for (const double degrees : {0.0, 20.0, 55.0, 89.0, 89.99}) {
    const double n = 1.7, c = cos_degrees(degrees),
                 inside = std::sqrt(1.0 - (1.0 - c * c) / (n * n));
    // From inside, g^2 is c^2 as a difference of numbers near 1: known to 2e-16, so F to 1e-16 / c.
    EXPECT_NEAR(fresnel_dielectric(c, n), fresnel_dielectric(inside, 1.0 / n), 1e-15 / c);
  }
}

TEST(FresnelDielectric, EqualIndicesReflectNothingAndGrazingEverything) {
  for (const double c : {0.0, 1e-8, 0.5, 1.0}) EXPECT_EQ(fresnel_dielectric(c, 1.0), 0.0);
  for (const double n : {1.0001, 1.5, 4.0, 0.5}) {
    EXPECT_NEAR(fresnel_dielectric(0.0, n), 1.0, 1e-12);
    EXPECT_NEAR(fresnel_dielectric(1e-12, n), 1.0, 1e-9);
  }
}

struct Metal {
  double n, k;
  std::vector<At> at;
  double hemispherical;
};

// Complex Fresnel equations; all digits from an independent evaluation. Au 632.8 nm, Ag 546.1 nm,
// Al and Cr 550 nm.
const std::vector<Metal> kMetals{
    {0.18344,
     3.4332,
     {{0, 0.94435898},
      {30, 0.94397841},
      {45, 0.9424388},
      {60, 0.93880841},
      {75, 0.93937451},
      {85, 0.96795593},
      {89, 0.99295797}},
     0.94242936},
    {0.13,
     3.3474,
     {{0, 0.95833997},
      {30, 0.9580525},
      {45, 0.9569021},
      {60, 0.95427137},
      {75, 0.95526328},
      {85, 0.97691046},
      {89, 0.99497709}},
     0.95700897},
    {0.958,
     6.69,
     {{0, 0.92113582},
      {30, 0.92046732},
      {45, 0.91736229},
      {60, 0.90692172},
      {75, 0.87834292},
      {85, 0.88462862},
      {89, 0.96703293}},
     0.91101975},
    {3.1812,
     3.3292,
     {{0, 0.55454746},
      {30, 0.55337834},
      {45, 0.54816618},
      {60, 0.53336413},
      {75, 0.51942128},
      {85, 0.64697025},
      {89, 0.89354027}},
     0.54584842},
};

TEST(FresnelConductor, IsAsPublished) {
  for (const Metal& metal : kMetals) {
    SCOPED_TRACE(metal.n);
    for (const At& at : metal.at) {
      const double c = cos_degrees(at.degrees);
      EXPECT_NEAR(fresnel_conductor(c, metal.n, metal.k), at.reflectance, 2e-8) << at.degrees;
      EXPECT_NEAR(fresnel_conductor(static_cast<float>(c), static_cast<float>(metal.n),
                                    static_cast<float>(metal.k)),
                  at.reflectance, 1e-6);
    }
    EXPECT_NEAR(hemispherical([&](double c) { return fresnel_conductor(c, metal.n, metal.k); }),
                metal.hemispherical, 2e-8);
  }
}

TEST(FresnelConductor, AgreesWithComplexArithmetic) {
  for (const double n : {0.05, 0.9, 3.0}) {
    for (const double k : {1e-3, 0.5, 8.0}) {
      for (const double degrees : {0.0, 40.0, 80.0, 89.9}) {
        const std::complex<double> index(n, k);
        const double c = cos_degrees(degrees);
        const auto g = std::sqrt(index * index - 1.0 + c * c);
        const auto s = (c - g) / (c + g), p = (index * index * c - g) / (index * index * c + g);
        EXPECT_NEAR(fresnel_conductor(c, n, k), 0.5 * (std::norm(s) + std::norm(p)), 1e-12);
      }
    }
  }
}

TEST(FresnelConductor, WithoutAbsorptionIsTheDielectric) {
  for (const double n : {0.6, 1.5}) {
    for (const double c : {0.01, 0.3, 0.9, 1.0}) {
      EXPECT_NEAR(fresnel_conductor(c, n, 0.0), fresnel_dielectric(c, n), 1e-12);
    }
  }
}

}  // namespace
}  // namespace nocturne

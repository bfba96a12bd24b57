#include <gtest/gtest.h>

#include <limits>

#include "kernel_checks.h"
#include "kernels/any_kernel.h"
#include "support/chi_square.h"

namespace nocturne {
namespace {

const Spectrum kClear(0.0f), kScatters(1.0f);
const Vec3 kFrom = normalized(Vec3{0.3f, -0.5f, 0.6f});

Phase henyey_greenstein(double g) { return {kClear, kScatters, HenyeyGreenstein(g)}; }
Phase molecules(float depolarisation) {
  return {kClear, kScatters, RayleighPhase(Spectrum(depolarisation))};
}

// Of cos^k over the sphere, by the density alone; Simpson's rule over x in [0, 1] with 1 - |cos| =
// x^8 on either side, so that peaks are resolved on both ends.
template <class Bound>
double moment(const Bound& kernel, int k, std::size_t lane = 0) {
  constexpr int kSteps = 20'000;
  double sum = 0.0;
  for (const double side : {1.0, -1.0}) {
    for (int i = 0; i <= kSteps; ++i) {
      const double x = static_cast<double>(i) / kSteps, off = std::pow(x, 8.0);
      const double c = side * (1.0 - off), r = std::sqrt(off * (2.0 - off));
      // In a frame in which single precision holds both ends.
      const Vec3 wi{static_cast<float>(r), 0.0f, static_cast<float>(c)};
      const double value = static_cast<double>(kernel.value({0.0f, 0.0f, -1.0f}, wi)[lane]);
      const double weight = i == 0 || i == kSteps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
      sum += weight / (3.0 * kSteps) * value * std::pow(c, k) * 8.0 * std::pow(x, 7.0);
    }
  }
  return 2.0 * std::numbers::pi * sum;
}

template <class Bound>
void expect_density(const Bound& kernel, double power, double side = 1.0) {
  test::expect_samples_match_pdf(
      [&](const Uniform4& u) { return kernel.sample(kFrom, test::kernel_numbers(u), 0)->wi; },
      [&](Vec3 wi) { return Spectral<1>(kernel.pdf(kFrom, wi)[0])[0]; }, 24,
      {.axis = static_cast<float>(-side) * kFrom, .power = power});
}

// 11 chi-square tests here, 12 below: one false alarm in 1,300 sets of other seeds.
TEST(Phase, HenyeyGreensteinDrawsItsDensity) {
  for (const double g : {0.0, 1e-7, 0.3, -0.6, 0.9}) {
    SCOPED_TRACE(g);
    const Phase phase = henyey_greenstein(g);
    expect_density(phase.bind(Shading<1>{}), g == 0.9 ? 4.0 : 1.0);
  }
  // Half of it within 0.01 and 0.0003 of the axis.
  for (const double g : {0.99, -0.99, 0.999, -0.999, 0.9999, -0.9999}) {
    SCOPED_TRACE(g);
    const Phase phase = henyey_greenstein(g);
    expect_density(phase.bind(Shading<1>{}), 8.0, g > 0.0 ? 1.0 : -1.0);
  }
}

TEST(Phase, HenyeyGreensteinHasItsMeanCosine) {
  for (const double g : {0.0, 1e-7, 0.3, -0.6, 0.9, 0.99, -0.999, 0.9999, -0.9999}) {
    const Phase phase = henyey_greenstein(g);
    const auto kernel = phase.bind(Shading<1>{});
    // Directions in single precision know an angle to 1e-7: against 1e-4, the widest peak's width,
    // that is 1e-3 in places, of either sign.
    const double tolerance = std::fabs(g) > 0.995 ? 2e-4 : 1e-5;
    EXPECT_NEAR(moment(kernel, 0), 1.0, tolerance) << g;
    EXPECT_NEAR(moment(kernel, 1), g, tolerance) << g;
    // Legendre moments are powers of g.
    EXPECT_NEAR(1.5 * moment(kernel, 2) - 0.5 * moment(kernel, 0), g * g, 2.0 * tolerance) << g;
    const auto mean = test::mean_of(200'000, [&](std::uint32_t i) {
      const auto draw = kernel.sample(kFrom, test::kernel_numbers(test::numbers(i, 3)), 0);
      return ScatteringAngle::between(kFrom, draw->wi).cosine();
    });
    EXPECT_NEAR(mean.value, g, 4.0 * mean.standard_error) << g;
  }
}

// Against the formula as it is printed, in long double.
TEST(Phase, HenyeyGreensteinIsThePublishedFormula) {
  for (const long double g : {-0.9999L, -0.5L, 0.0L, 0.1L, 0.85L, 0.9999L}) {
    const Phase phase = henyey_greenstein(static_cast<double>(g));
    const auto kernel = phase.bind(Shading<1>{});
    for (const double degrees : {0.0, 0.01, 1.0, 30.0, 90.0, 179.0, 179.99}) {
      const Vec3 wi = test::direction(degrees);
      const long double cosine =
          static_cast<long double>(ScatteringAngle::between({0.0f, 0.0f, -1.0f}, wi).cosine());
      const long double printed = (1.0L - g * g) / (4.0L * std::numbers::pi_v<long double>) /
                                  std::pow(1.0L + g * g - 2.0L * g * cosine, 1.5L);
      EXPECT_NEAR(static_cast<double>(
                      static_cast<long double>(kernel.value({0.0f, 0.0f, -1.0f}, wi)[0]) / printed),
                  1.0, 2e-6)
          << static_cast<double>(g) << ' ' << degrees;
    }
  }
}

TEST(Phase, DoubleHenyeyGreenstein) {
  const Phase phase{kClear, kScatters, DoubleHenyeyGreenstein(0.8, -0.4, 0.7)};
  const auto kernel = phase.bind(Shading<1>{});
  expect_density(kernel, 1.0);
  EXPECT_NEAR(moment(kernel, 0), 1.0, 1e-5);
  EXPECT_NEAR(moment(kernel, 1), 0.7 * 0.8 - 0.3 * 0.4, 1e-5);
}

// Moments by hand: <cos^2> of 1 is 1/3 and of cos^2 itself 3/5.
TEST(Phase, RayleighDrawsItsDensityAndHasItsMoments) {
  for (const float d : {0.0f, 0.03f, 0.5f, 0.999f, 1.0f}) {
    SCOPED_TRACE(d);
    const Phase phase = molecules(d);
    const auto kernel = phase.bind(Shading<1>{});
    expect_density(kernel, 1.0);
    const double gamma = static_cast<double>(d) / (2.0 - static_cast<double>(d));
    EXPECT_NEAR(moment(kernel, 0), 1.0, 1e-5);
    EXPECT_NEAR(moment(kernel, 1), 0.0, 1e-5);
    const double second =
        3.0 / (4.0 * (1.0 + 2.0 * gamma)) * ((1.0 + 3.0 * gamma) / 3.0 + (1.0 - gamma) / 5.0);
    EXPECT_NEAR(moment(kernel, 2), second, 1e-5);
    const auto mean = test::mean_of(200'000, [&](std::uint32_t i) {
      const auto draw = kernel.sample(kFrom, test::kernel_numbers(test::numbers(i, 3)), 0);
      return std::pow(ScatteringAngle::between(kFrom, draw->wi).cosine(), 2.0);
    });
    EXPECT_NEAR(mean.value, second, 4.0 * mean.standard_error);
  }
  const Phase none{kClear, kScatters, RayleighPhase(std::nullopt)};
  EXPECT_FLOAT_EQ(none.bind(Shading<1>{}).value({0, 0, 1}, {1, 0, 0})[0], 0.1875f * kInvPi);
}

// Bucholtz 1995, equation 12, at 90 degrees and straight on, for the depolarisation of air at 550
// nm (2.842e-2, his table 1).
TEST(Phase, RayleighIsThePublishedFormula) {
  const Phase phase = molecules(2.842e-2f);
  const auto kernel = phase.bind(Shading<1>{});
  const double gamma = 2.842e-2 / (2.0 - 2.842e-2);
  const double factor = 3.0 / (16.0 * std::numbers::pi * (1.0 + 2.0 * gamma));
  EXPECT_NEAR(kernel.value({0, 0, 1}, {0, 1, 0})[0], factor * (1.0 + 3.0 * gamma), 1e-7);
  EXPECT_NEAR(kernel.value({0, 0, 1}, {0, 0, -1})[0], factor * 2.0 * (1.0 + gamma), 1e-7);
}

// A peak of 1e4 within 1 - cos = 1e-6, as large droplets have; a gap; a step.
std::vector<double> peaked_cosines() {
  return {-1.0, -0.9, -0.2, 0.1, 0.3, 0.9, 1.0 - 1e-3, 1.0 - 1e-5, 1.0 - 1e-6, 1.0};
}
TabulatedPhase peaked() {
  return {{400.0, 500.0, 700.0},
          peaked_cosines(),
          {0.1f, 0.2f, 0.1f, 0.0f, 0.0f, 3.0f, 20.0f, 2e3f, 1e4f, 1e4f,  //
           1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f,  1.0f, 1.0f, 1.0f,  //
           9.0f, 0.0f, 0.0f, 1.0f, 0.5f, 0.1f, 0.0f,  5e5f, 5e5f, 0.0f}};
}

TEST(Phase, TableDrawsItsDensity) {
  const Phase phase{kClear, kScatters, peaked()};
  for (const float nm : {300.0f, 430.0f, 500.0f, 650.0f, 800.0f}) {
    SCOPED_TRACE(nm);
    const auto kernel = phase.bind(Shading<1>{.wavelengths = nm});
    expect_density(kernel, 4.0);
    EXPECT_NEAR(moment(kernel, 0), 1.0, 2e-4);
  }
  // The mean of four wavelengths is what a group draws from.
  const auto group =
      phase.bind(Shading<4>{.wavelengths = test::lanes(380.0f, 480.0f, 580.0f, 680.0f)});
  expect_density(group, 4.0);
  // By the path pdf ratios of its photons, where media have made them unlike.
  auto shading = Shading<4>{.wavelengths = test::lanes(380.0f, 480.0f, 580.0f, 680.0f)};
  shading.path_pdf_ratio = test::lanes(0.0f, 0.6f, 0.1f, 0.3f);
  const auto unlike = phase.bind(shading);
  expect_density(unlike, 4.0);
  const Vec3 to{0.6f, 0.0f, 0.8f};
  const float mean = unlike.pdf(kFrom, to)[0];
  EXPECT_NEAR(sum(shading.path_pdf_ratio * unlike.value(kFrom, to)), mean, 1e-5f * mean);
  EXPECT_NEAR(sum(shading.path_pdf_ratio * unlike.likelihood(kFrom, to)), 1.0f, 1e-5f);
}

// A linear density, known in closed form: (1 + a cos) / (4 pi), with mean cosine a / 3.
TEST(Phase, TableIsLinearInCosineAndWavelength) {
  const Phase phase{
      kClear, kScatters,
      TabulatedPhase({400.0, 600.0}, {-1.0, 0.5, 1.0}, {0.5f, 1.25f, 1.5f, 6.0f, 3.0f, 2.0f})};
  const auto kernel =
      phase.bind(Shading<4>{.wavelengths = test::lanes(350.0f, 400.0f, 450.0f, 900.0f)});
  const double slopes[]{0.5, 0.5, 0.75 * 0.5 - 0.25 * 0.5, -0.5};
  for (std::size_t lane = 0; lane < 4; ++lane) {
    for (const double degrees : {0.0, 40.0, 100.0, 180.0}) {
      const double cosine = std::cos(degrees * std::numbers::pi / 180.0);
      const double expected = (1.0 + slopes[lane] * cosine) / (4.0 * std::numbers::pi);
      EXPECT_NEAR(kernel.value({0, 0, -1}, test::direction(degrees))[lane], expected, 1e-7);
    }
    EXPECT_NEAR(moment(kernel, 1, lane), slopes[lane] / 3.0, 1e-6);
  }
}

// Elements times the phase function are linear between cosines; ours are across the plane of
// scattering, Bohren and Huffman's in it.
TEST(Phase, AMatrixIsLinearTimesThePhaseFunction) {
  const ScatteringElements back{0.0f, 0.9f, -0.5f, 0.2f, -0.4f}, on{-0.4f, 0.8f, 0.5f, -0.1f, 0.6f};
  const Phase phase{kClear, kScatters,
                    TabulatedPhase({500.0}, {-1.0, 1.0}, {1.0f, 3.0f}, {back, on})};
  const auto kernel = phase.bind(Shading<1>{.wavelengths = 500.0f});
  // Across, the phase function is the mean of both ends: a quarter of it comes from one.
  const auto found = mueller_of<1>(kernel, {0, 0, -1}, Draw<1>{.wi = {1, 0, 0}}, 1u);
  const auto mean = [](float a, float b) { return 0.25f * a + 0.75f * b; };
  EXPECT_NEAR(found.b[0], -mean(back.s12, on.s12), 1e-6);
  EXPECT_NEAR(found.a[0], mean(back.s22, on.s22), 1e-6);
  EXPECT_NEAR(found.c[0], mean(back.s33, on.s33), 1e-6);
  EXPECT_NEAR(found.d[0], mean(back.s44, on.s44), 1e-6);
  EXPECT_NEAR(found.s[0], -mean(back.s34, on.s34), 1e-6);
  EXPECT_THROW(TabulatedPhase({500.0}, {-1.0, 1.0}, {1.0f, 3.0f}, {back}), std::invalid_argument);
  const ScatteringElements beyond{1.5f, 1.0f, 1.0f, 0.0f, 1.0f};
  EXPECT_THROW(TabulatedPhase({500.0}, {-1.0, 1.0}, {1.0f, 3.0f}, {back, beyond}),
               std::invalid_argument);
}

TEST(Phase, AlbedoIsTheShareThatScatters) {
  const Phase phase{Spectrum(400.0f, 300.0f, {0.0f, 3.0f}, true),
                    Spectrum(400.0f, 300.0f, {2.0f, 1.0f}, true), HenyeyGreenstein(0.5)};
  const auto kernel =
      phase.bind(Shading<4>{.wavelengths = test::lanes(400.0f, 550.0f, 700.0f, 800.0f)});
  const auto albedo = kernel.albedo({0, 0, 1});
  EXPECT_EQ(albedo[0], 1.0f);
  EXPECT_FLOAT_EQ(albedo[1], 0.5f);
  EXPECT_FLOAT_EQ(albedo[2], 0.25f);
  EXPECT_EQ(albedo[3], 0.0f);  // nothing there
  const Vec3 wi = test::direction(70.0);
  EXPECT_EQ(kernel.value({0, 0, 1}, wi)[2], 0.25f * kernel.pdf({0, 0, 1}, wi)[0]);
}

// Photons of a group stay together, and whoever leads, value over density is right for all: the
// weights of a wavelength's photons add up to its albedo.
TEST(Phase, AGroupNeverParts) {
  std::vector<Phase> phases;
  phases.push_back({kClear, kScatters, peaked()});
  phases.push_back(
      {kClear, kScatters, RayleighPhase(Spectrum(400.0f, 300.0f, {0.9f, 0.0f}, false))});
  for (const Phase& phase : phases) {
    const auto group =
        phase.bind(Shading<4>{.wavelengths = test::lanes(400.0f, 480.0f, 590.0f, 700.0f)});
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const auto mean = test::mean_of(200'000, [&](std::uint32_t i) {
        return test::weight(group, kFrom, test::kernel_numbers(test::numbers(i, 1)), lane);
      });
      EXPECT_NEAR(mean.value, 1.0, 4.0 * mean.standard_error);
      const auto u = test::kernel_numbers(test::numbers(7, 8));
      const auto lead = group.sample(kFrom, u, lane);
      EXPECT_EQ(lead->coherent, kAllCoherent<4>);
      EXPECT_EQ(lead->wi.x, group.sample(kFrom, u, 0)->wi.x);
    }
  }
}

TEST(Phase, IsSoundAtEveryExtreme) {
  std::vector<Phase> phases;
  for (const double g : {0.0, 1e-30, 0.9999, -0.9999, 1.0 - 1e-12, 1e-16 - 1.0}) {
    phases.push_back(henyey_greenstein(g));
  }
  for (const float d : {0.0f, 1e-30f, 1.0f - 1e-7f, 1.0f}) phases.push_back(molecules(d));
  phases.push_back({kClear, kScatters, peaked()});
  phases.push_back({kClear, kScatters,
                    TabulatedPhase({500.0}, {-1.0, std::nextafter(1.0, 0.0), 1.0},
                                   {0.0f, std::numeric_limits<float>::denorm_min(), 0.0f})});
  const float below_one = std::nextafter(1.0f, 0.0f);
  for (const Phase& phase : phases) {
    const auto kernel = phase.bind(Shading<1>{.wavelengths = 500.0f});
    for (const float part : {0.0f, below_one}) {
      for (const float u : {0.0f, 1e-9f, 0.5f, below_one}) {
        for (const Vec3 wo : {kFrom, Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}}) {
          const Vec3 wi = kernel.sample(wo, {part, u, 0.3f}, 0)->wi;
          ASSERT_NEAR(length(wi), 1.0f, 1e-6f);
          for (const Vec3 toward : {wi, wo, -wo}) {
            ASSERT_TRUE(std::isfinite(kernel.pdf(wo, toward)[0]));
            ASSERT_GE(kernel.pdf(wo, toward)[0], 0.0f);
          }
        }
      }
    }
  }
}

TEST(Phase, RefusesWhatIsNoPhaseFunction) {
  const double nan = std::nan("");
  for (const double g : {1.0, -1.0, 2.0, nan}) {
    EXPECT_THROW(HenyeyGreenstein{g}, std::invalid_argument);
  }
  for (const double w : {-0.1, 1.1, nan}) {
    EXPECT_THROW(DoubleHenyeyGreenstein(0.1, 0.2, w), std::invalid_argument);
  }
  EXPECT_THROW(RayleighPhase(Spectrum(-0.1f)), std::invalid_argument);
  using Row = std::vector<double>;
  using Values = std::vector<float>;
  const auto refused = [](const Row& wavelengths, const Row& cosines, const Values& values) {
    EXPECT_THROW(TabulatedPhase(wavelengths, cosines, values), std::invalid_argument);
  };
  const Row ends{-1.0, 1.0};
  EXPECT_NO_THROW(TabulatedPhase({500.0}, ends, {1.0f, 0.0f}));
  refused({}, ends, {});
  refused({500.0}, {1.0}, {1.0f});
  refused({500.0}, ends, {1.0f});
  refused({500.0}, ends, {1.0f, 1.0f, 1.0f});
  refused({500.0, 500.0}, ends, Values(4, 1.0f));
  refused({nan}, ends, {1.0f, 1.0f});
  refused({500.0}, {-1.0, 0.9}, {1.0f, 1.0f});
  refused({500.0}, {-0.9, 1.0}, {1.0f, 1.0f});
  refused({500.0}, {-1.0, 0.2, 0.2, 1.0}, Values(4, 1.0f));
  refused({500.0}, {-1.0, nan, 1.0}, Values(3, 1.0f));
  refused({500.0}, ends, {0.0f, 0.0f});
  refused({500.0}, ends, {1.0f, -1.0f});
  refused({500.0}, ends, {1.0f, std::nanf("")});
  refused({500.0}, ends, {1.0f, HUGE_VALF});
  refused(Row(10'001, 1.0), ends, Values(20'002, 1.0f));
}

TEST(Phase, IsNoPartOfABlend) {
  const std::vector<AnyKernel> kernels{henyey_greenstein(0.0), Blend{{{0, {}}}}};
  EXPECT_THROW(check_blends(kernels), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

// Environment and distant discs: draws against densities, irradiances against answers on paper.
#include <limits>

#include "luminaires/distant_disc.h"
#include "luminaires/environment.h"
#include "support/chi_square.h"
#include "support/irradiance.h"

namespace nocturne {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr LightSamplingContext kUp{{0, 0, 0}, {0, 0, 1}};
using Texel = EnvironmentMap::Texel;

// c0 = c1 = c2 = 0 is S = 1/2.
Texel grey(double radiance) { return {static_cast<float>(2.0 * radiance), 0, 0, 0}; }

template <class Radiance>
EnvironmentMap make_map(std::uint32_t columns, std::uint32_t rows, const Radiance& radiance,
                        EnvironmentMap::Axes axes = {}) {
  std::vector<Texel> texels;
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) texels.push_back(grey(radiance(r, c)));
  }
  return EnvironmentMap(columns, rows, std::move(texels), Spectrum(1.0f), axes);
}

std::optional<Vec3> direction_of(const std::optional<Environment::Drawn>& drawn) {
  if (!drawn) return std::nullopt;
  return drawn->direction;
}

// As LightSampler asks both.
struct Sampled {
  const Environment& environment;
  std::optional<Vec3> sample(const LightSamplingContext& from, float choice, float u1,
                             float u2) const {
    return direction_of(environment.draw(from, choice, u1, u2));
  }
  float pdf(const LightSamplingContext& from, Vec3 w) const { return environment.pdf(from, w); }
};

struct Uniformly {
  static std::optional<Vec3> sample(const LightSamplingContext& from, float, float u1, float u2) {
    const Vec3 w = UniformSphere::sample(u1, u2);
    if (!from.sees(w)) return std::nullopt;
    return w;
  }
  static float pdf(const LightSamplingContext&, Vec3) { return UniformSphere::pdf(); }
};

auto radiance_of(const Environment& e) {
  return [&e](Vec3 w) { return static_cast<double>(e.radiance(w, Spectral<1>(550.0f))[0]); };
}

void expect_consistent(const Environment& environment, const LightSamplingContext& from) {
  test::expect_samples_match_pdf(
      [&](const Uniform4& u) { return direction_of(environment.draw(from, u[0], u[1], u[2])); },
      [&](Vec3 w) { return environment.pdf(from, w); });
}

TEST(Environment, ConstantSamplesMatchPdf) {
  const Environment environment(Spectrum(0.7f));
  const Vec3 n = normalized({1, 2, -0.5f});
  expect_consistent(environment, {{}, n});
  expect_consistent(environment, {{}, n, true});
}

TEST(Environment, MapSamplesMatchPdf) {
  const auto bumpy = [](std::uint32_t r, std::uint32_t c) {
    return r == 3 && c == 5 ? 100.0 : c % 3 == 0 ? 0.0 : 1.0 + r + 0.3 * c;
  };
  const Vec3 z = normalized({0.2f, 0.3f, 1.0f}), x = normalized(cross({0, 1, 0}, z));
  const EnvironmentMap::Axes tilted{x, cross(z, x), z};
  const Environment straight(make_map(24, 16, bumpy)), turned(make_map(24, 16, bumpy, tilted));
  // Floor, ceiling, walls (half turns, also around the back), tilted, all around.
  for (const Vec3 n : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{-1, 0, 0},
                       Vec3{0.6f, -0.8f, 0}, normalized({1, 1, 0.4f}), normalized({1, 1, -2})}) {
    expect_consistent(straight, {{}, n});
  }
  expect_consistent(straight, {{}, {0, 0, 1}, true});
  expect_consistent(turned, {{}, {0, 0, 1}});
  expect_consistent(turned, {{}, x});

  // In strips of four columns, the last one narrower; walls see some of them, around the back, too.
  const auto banded = [](std::uint32_t r, std::uint32_t c) {
    return c / 50 == 2 ? 40.0 : 1.0 + r + 0.02 * c;
  };
  const Environment wide(make_map(203, 6, banded));
  for (const Vec3 n : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{-1, 0, 0},
                       Vec3{0.6f, -0.8f, 0}, Vec3{-0.8f, 0.6f, 0}}) {
    expect_consistent(wide, {{}, n});
  }
}

// Density and radiance come with a direction as its own place has them, but where rounding moves
// it across a texel's edge.
TEST(Environment, WhatIsDrawnIsWhatIsThere) {
  const Environment map(make_map(
      203, 64, [](std::uint32_t r, std::uint32_t c) { return 1.0 + (7 * r + 13 * c) % 11; })),
      constant(Spectrum(0.7f));
  const Spectral<1> nm(550.0f);
  for (const Environment* e : {&map, &constant}) {
    for (const Vec3 n : {Vec3{0, 0, 1}, Vec3{-1, 0, 0}, normalized({1, 1, 0.4f})}) {
      int drawn = 0, others = 0;
      for (std::uint32_t i = 0; i < 10'000; ++i) {
        const auto u = test::numbers(i);
        const auto it = e->draw({{}, n}, u[0], u[1], u[2]);
        if (!it) continue;
        ++drawn;
        others += it->pdf != e->pdf({{}, n}, it->direction) ||
                  e->radiance(*it, nm)[0] != e->radiance(it->direction, nm)[0];
      }
      EXPECT_GT(drawn, 4000);
      EXPECT_LT(others, 10);
    }
  }
}

// One bright texel among 131,072 at 1,000,000:1, in the row of the pole. A row i of R contributes
// pi (z0^2 - z1^2) all around, as its texels are equal steps of z.
TEST(Environment, BrightTexelAtThePole) {
  constexpr std::uint32_t kColumns = 512, kRows = 256;
  const double bright = 1e6, dim = 1.0;
  const Environment environment(make_map(kColumns, kRows, [&](std::uint32_t r, std::uint32_t c) {
    return r == 0 && c == 100 ? bright : dim;
  }));
  const double z1 = 1.0 - 2.0 / kRows;
  const double truth = kPiD * dim + kPiD * (1.0 - z1 * z1) / kColumns * (bright - dim);
  const auto radiance = radiance_of(environment);
  const auto by_map = test::irradiance(Sampled{environment}, kUp, radiance);
  test::expect_mean(by_map, truth, 1e-4);
  EXPECT_LT(by_map.relative_spread(), 0.5);

  // Chance meets it once in 131,072: with 3 million draws it is about 23 times, enough to compare.
  const auto by_chance = test::irradiance(Uniformly{}, kUp, radiance, 3'000'000);
  EXPECT_NEAR(by_chance.mean, by_map.mean, 4.5 * by_chance.stderr_of_mean());
}

// The same bright texel below the horizon is not drawn, and dim texels above it are.
TEST(Environment, WindowLeavesOutWhatIsBelow) {
  const Environment environment(make_map(
      512, 256, [](std::uint32_t r, std::uint32_t c) { return r == 200 && c == 100 ? 1e6 : 1.0; }));
  const auto up = test::irradiance(Sampled{environment}, kUp, radiance_of(environment));
  test::expect_mean(up, kPiD, 1e-4);
  EXPECT_LT(up.relative_spread(), 0.7);
  // A wall that faces away from column 100 of 512.
  const float phi = kTwoPi * 100.5f / 512.0f;
  const LightSamplingContext wall{{}, {-std::cos(phi), -std::sin(phi), 0}};
  const auto away = test::irradiance(Sampled{environment}, wall, radiance_of(environment));
  test::expect_mean(away, kPiD, 1e-4);
  EXPECT_LT(away.relative_spread(), 0.8);
}

TEST(Environment, BlackIsNotSampled) {
  const Environment map(make_map(8, 4, [](auto, auto) { return 0.0; }));
  const Environment constant(Spectrum(0.0f));
  for (const Environment* e : {&map, &constant}) {
    EXPECT_FALSE(e->draw(kUp, 0.5f, 0.5f, 0.5f));
    EXPECT_EQ(e->pdf(kUp, {0, 0, 1}), 0.0f);
    EXPECT_EQ(e->radiance(Vec3{0, 0, 1}, Spectral<1>(550.0f))[0], 0.0f);
  }
  // Black above, and lit below.
  const Environment lower(make_map(8, 4, [](auto r, auto) { return r == 3 ? 1.0 : 0.0; }));
  EXPECT_FALSE(lower.draw(kUp, 0.5f, 0.5f, 0.5f));
}

// Every bit of the sums, however dark the texel: 1e-12 of the brightest is still drawn from.
TEST(Environment, DarkTexelsKeepADensity) {
  const Environment environment(make_map(
      64, 32, [](std::uint32_t r, std::uint32_t c) { return r == 5 && c == 9 ? 1e6 : 1e-12; }));
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const auto u = test::numbers(i);
    EXPECT_GT(environment.pdf({{}, {0, 0, 1}, true}, UniformSphere::sample(u[0], u[1])), 0.0f);
  }
}

TEST(Environment, LargestUnitNumbers) {
  const Environment environment(make_map(8, 4, [](auto r, auto c) { return r == 3 && c == 7; }));
  constexpr float kLast = 0x1.fffffep-1f;
  for (const float u : {0.0f, kLast}) {
    for (const float v : {0.0f, kLast}) {
      const LightSamplingContext from{{}, {0, 0, 1}, true};
      const auto w = direction_of(environment.draw(from, u, u, v));
      ASSERT_TRUE(w);
      EXPECT_TRUE(std::isfinite(w->x) && std::isfinite(w->y) && std::isfinite(w->z));
    }
  }
}

// Jakob and Hanika's sigmoid over wavelengths, times the map's spectrum.
TEST(Environment, TexelSpectrum) {
  const Texel t{3.0f, 1e-4f, -0.1f, 24.0f};
  const Spectrum spectrum(400.0f, 300.0f, {1.0f, 4.0f}, false);
  const Environment e(EnvironmentMap(1, 1, {t}, spectrum, {}));
  Spectral<4> nm;
  nm.lanes = Spectral<4>::Lanes{400.0f, 480.0f, 600.0f, 700.0f};
  const auto radiance = e.radiance(Vec3{0, 0, 1}, nm);
  double mean = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = 1e-4 * nm[i] * nm[i] - 0.1 * nm[i] + 24.0;
    const double s = 0.5 + x / (2.0 * std::sqrt(1.0 + x * x));
    EXPECT_NEAR(radiance[i], 3.0 * s * (1.0 + 0.01 * (nm[i] - 400.0)), 1e-3);
  }
  for (int l = 380; l < 780; ++l) {
    const double x = 1e-4 * l * l - 0.1 * l + 24.0;
    mean +=
        3.0 / 400.0 * (0.5 + x / (2.0 * std::sqrt(1.0 + x * x))) * spectrum(static_cast<float>(l));
  }
  EXPECT_NEAR(e.mean_radiance(), mean, 0.01 * mean);  // bands of 20 nm
}

TEST(Sigmoid, NeverOutsideItsRange) {
  for (const float x : {0.0f, 1.0f, -1.0f, 1e3f, -1e3f, 1e15f, -1e15f, 3e38f, -3e38f}) {
    EXPECT_GE(sigmoid(x), 0.0f);
    EXPECT_LE(sigmoid(x), 1.0f);
  }
  EXPECT_NEAR(sigmoid(-1e4f), 2.5e-9f, 1e-14f);
}

TEST(Environment, RefusesNonsense) {
  const auto map = [](std::uint32_t columns, std::uint32_t rows, std::vector<Texel> texels,
                      EnvironmentMap::Axes axes = {}) {
    return EnvironmentMap(columns, rows, std::move(texels), Spectrum(1.0f), axes);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NO_THROW(map(1, 1, {grey(1)}));
  EXPECT_THROW(map(0, 1, {}), std::invalid_argument);
  EXPECT_THROW(map(2, 1, {grey(1)}), std::invalid_argument);
  EXPECT_THROW(map(8193, 1, std::vector<Texel>(8193)), std::invalid_argument);
  EXPECT_THROW(map(1, 1, {grey(-1)}), std::invalid_argument);
  EXPECT_THROW(map(1, 1, {{1, nan, 0, 0}}), std::invalid_argument);
  EXPECT_THROW(map(1, 1, {grey(1)}, {{1, 0, 0}, {1, 0, 0}, {0, 0, 1}}), std::invalid_argument);
}

// Uniform sky pi (1 + cos b) / 2; CIE overcast sky (1 + 2 cos z) / 3, Moon and Spencer 1942: 7 pi /
// 9 on the ground, pi / 6 + 4 / 9 on a wall; others by quadrature. Black below.
TEST(Irradiance, TiltedPlanesUnderSkies) {
  struct Case {
    double tilt, uniform, overcast;
  };
  constexpr std::uint32_t kRows = 2048;
  // The mean of 1 + 2 z over a row is its value in the middle: no texel is wrong by more than the
  // cosine's change inside a row, second order in 1 / 2048.
  const auto overcast = [](std::uint32_t r, std::uint32_t) {
    const double z = 1.0 - 2.0 * (r + 0.5) / kRows;
    return z > 0.0 ? (1.0 + 2.0 * z) / 3.0 : 0.0;
  };
  const auto half = [](std::uint32_t r, std::uint32_t) { return r < kRows / 2 ? 1.0 : 0.0; };
  const Environment sky(make_map(8, kRows, half)), cie(make_map(8, kRows, overcast));
  const Environment constant(Spectrum(1.0f));
  for (const Case c : {Case{0, 3.1415927, 2.443461}, Case{30, 2.9311458, 2.2069372},
                       Case{60, 2.3561945, 1.6357195}, Case{90, 1.5707963, 0.96804322}}) {
    const double b = c.tilt * kPiD / 180.0;
    const LightSamplingContext from{
        {}, {static_cast<float>(std::sin(b)), 0, static_cast<float>(std::cos(b))}};
    test::expect_mean(test::irradiance(Sampled{sky}, from, radiance_of(sky), 400'000), c.uniform);
    test::expect_mean(test::irradiance(Sampled{cie}, from, radiance_of(cie), 400'000), c.overcast);
    const auto upper = [](Vec3 w) { return w.z > 0.0f ? 1.0 : 0.0; };
    test::expect_mean(test::irradiance(Sampled{constant}, from, upper, 400'000), c.uniform);
  }
}

struct DiscOnly {
  const DistantDisc& disc;
  std::optional<Vec3> sample(const LightSamplingContext&, float, float u1, float u2) const {
    return disc.sample(u1, u2);
  }
  float pdf(const LightSamplingContext&, Vec3 w) const { return disc.pdf(w); }
};

const Vec3 kSun = normalized({0.3f, -0.4f, 0.7f});

// pi L sin^2 h, from the very small to the hemisphere: nothing is lost to rounding.
TEST(DistantDisc, Irradiance) {
  for (const double h : {1e-4, 4.65e-3, 0.1, 1.0, 0.5 * kPiD}) {
    const DistantDisc disc(kSun, h, Spectrum(2.0f));
    const auto radiance = [&](Vec3 w) {
      return static_cast<double>(disc.radiance(w, Spectral<1>(550.0f))[0]);
    };
    const double truth = 2.0 * kPiD * std::sin(h) * std::sin(h);
    const LightSamplingContext facing{{}, kSun};
    // Without the rim a tenth of a per mille is what float leaves of a disc of 1e-4.
    test::expect_mean(test::irradiance(DiscOnly{disc}, facing, radiance, 400'000), truth, 1e-4);
    EXPECT_NEAR(disc.irradiance(kSun, false), truth, 1e-3 * truth);
  }
}

TEST(DistantDisc, SamplesMatchPdf) {
  for (const double h : {0.3, 1.0, 0.5 * kPiD}) {
    const DistantDisc disc(kSun, h, Spectrum(2.0f));
    test::expect_samples_match_pdf([&](const Uniform4& u) { return disc.sample(u[0], u[1]); },
                                   [&](Vec3 w) { return disc.pdf(w); });
  }
}

// Rings of equal solid angle, and sectors, of a disc too small for cells over the sphere.
TEST(DistantDisc, SmallDiscIsUniform) {
  constexpr int kRings = 20, kSectors = 12, kDraws = 100'000;
  const double h = 1e-4 + kDirectionRounding;
  const DistantDisc disc(kSun, 1e-4, Spectrum(1.0f));
  const Frame frame(kSun);
  std::vector<double> observed(kRings * kSectors), expected(kRings * kSectors);
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const auto u = test::numbers(i);
    const Vec3 w = disc.sample(u[0], u[1]), chord = w - kSun;
    const double ring = dot(chord, chord) / (h * h) * kRings;
    const double sector =
        (std::atan2(dot(chord, frame.bitangent), dot(chord, frame.tangent)) / (2.0 * kPiD) + 0.5) *
        kSectors;
    const int cell = std::min(kRings - 1, static_cast<int>(ring)) * kSectors +
                     std::min(kSectors - 1, static_cast<int>(sector));
    observed[static_cast<std::size_t>(cell)] += 1.0;
  }
  for (auto& e : expected) e = static_cast<double>(kDraws) / (kRings * kSectors);
  test::expect_same_counts(observed, expected);
  EXPECT_NEAR(disc.pdf(kSun) * kPiD * h * h, 1.0, 1e-3);
}

// mu^k over the disc: the irradiance is 2 pi L sin^2 h / (k + 2), exactly, as mu d(mu) is the
// projected solid angle.
TEST(DistantDisc, LimbDarkening) {
  const DistantDisc::LimbDarkening limb{
      {Spectrum(0.3f), Spectrum(400.0f, 400.0f, {0.8f, 1.2f}, false), Spectrum(0.0f)},
      {Spectrum(0.0f), Spectrum(0.1f), Spectrum(0.2f)}};
  for (const double h : {4.65e-3, 0.8}) {
    const DistantDisc disc(kSun, h, Spectrum(1.0f), limb);
    const auto radiance = [&](Vec3 w) {
      return static_cast<double>(disc.radiance(w, Spectral<1>(600.0f))[0]);
    };
    const double s2 = std::sin(h) * std::sin(h);
    const double truth = 2.0 * kPiD * s2 * (0.3 / 2.0 + 0.9 / 3.0 - 0.2 / 4.0);
    test::expect_mean(test::irradiance(DiscOnly{disc}, {{}, kSun}, radiance, 400'000), truth, 1e-4);
    EXPECT_NEAR(radiance(kSun), 0.3 + 0.9 - 0.2, 1e-5);
  }
  // Never negative, whatever the polynomial.
  const DistantDisc dark(kSun, 0.2, Spectrum(1.0f), {{}, {Spectrum(1.0f)}});
  EXPECT_EQ(dark.radiance(kSun, Spectral<1>(600.0f))[0], 0.0f);
}

TEST(DistantDisc, RefusesNonsense) {
  for (const double h : {0.0, -1.0, 1.6, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(DistantDisc(kSun, h, Spectrum(1.0f)), std::invalid_argument);
  }
  EXPECT_THROW(DistantDisc({0, 0, 2}, 0.1, Spectrum(1.0f)), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

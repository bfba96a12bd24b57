// What a luminaire emits, against the flux that it should have.
#include "luminaires/luminaire.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vector>

#include "math/frame.h"
#include "pdfs/directions.h"

namespace nocturne {
namespace {

constexpr double kPiD = std::numbers::pi;
const Vec3 kNormal = normalized({0.3f, -0.5f, 0.8f});

float emitted(const Luminaire& luminaire, Vec3 away, Vec3 normal = kNormal) {
  return luminaire.emitted<1>(normal, away, {}, Spectral<1>(550.0f))[0];
}

Luminaire luminaire(AngularProfile profile, bool two_sided = false, float radiance = 2.0f) {
  return Luminaire(0, Colour(Spectrum(radiance)), two_sided, std::move(profile));
}

// The integral over directions around the normal, by midpoints in cos(theta) and phi.
template <class F>
double integrate(const F& f) {
  constexpr int kRows = 800, kColumns = 400;
  const Frame frame(kNormal);
  double sum = 0.0;
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kColumns; ++j) {
      const Vec3 w =
          frame.to_world(direction_from_z(2.0f * (static_cast<float>(i) + 0.5f) / kRows - 1.0f,
                                          (static_cast<float>(j) + 0.5f) / kColumns));
      sum += f(w);
    }
  }
  return sum * 4.0 * kPiD / (kRows * kColumns);
}

double exitance(const Luminaire& l) {
  return integrate(
      [&](Vec3 w) { return emitted(l, w) * std::fabs(static_cast<double>(dot(kNormal, w))); });
}

IntensityProfile::Table table(std::vector<float> vertical, std::vector<float> horizontal,
                              std::vector<float> values) {
  const Frame frame(kNormal);
  return {kNormal, frame.tangent, std::move(vertical), std::move(horizontal), std::move(values)};
}

TEST(Luminaire, LambertianSides) {
  EXPECT_EQ(emitted(luminaire(LambertianProfile{}), kNormal), 2.0f);
  EXPECT_EQ(emitted(luminaire(LambertianProfile{}), -kNormal), 0.0f);
  EXPECT_EQ(emitted(luminaire(LambertianProfile{}, true), -kNormal), 2.0f);
  EXPECT_NEAR(exitance(luminaire(LambertianProfile{})), 2.0 * kPiD, 1e-4);
}

// M = 2 pi L / (p + 2).
TEST(Luminaire, CosinePower) {
  for (const float p : {0.0f, 0.5f, 1.0f, 7.0f, 40.0f}) {
    EXPECT_NEAR(exitance(luminaire(CosinePowerProfile{p})), 4.0 * kPiD / (p + 2.0), 1e-3);
    EXPECT_NEAR(exitance(luminaire(CosinePowerProfile{p}, true)), 8.0 * kPiD / (p + 2.0), 2e-3);
  }
}

// Whatever its shape, a lamp's flux is its profile's.
TEST(Luminaire, IntensityOverProjectedArea) {
  const IntensityProfile profile(table({0.0f, 0.5f, 1.2f, 1.5f}, {0.0f, 2.0f, 5.0f, kTwoPi},
                                       {1, 3, 2, 0, 4, 1, 1, 0, 2, 2, 2, 0, 1, 3, 2, 0}));
  const double flux = profile.flux();
  EXPECT_NEAR(integrate([&](Vec3 w) { return profile(w); }), flux, 1e-3 * flux);

  const Luminaire flat = luminaire(IntensityLamp{profile, 0.25f, true});
  EXPECT_NEAR(0.25 * exitance(flat), 2.0 * flux, 2e-3 * flux);

  // A sphere's radiance depends on direction alone: intensity is radiance x pi r^2.
  const float cross_section = kPi * 0.04f;
  const Luminaire ball = luminaire(IntensityLamp{profile, cross_section, false});
  EXPECT_NEAR(integrate([&](Vec3 w) { return emitted(ball, w, w) * cross_section; }), 2.0 * flux,
              2e-3 * flux);
  EXPECT_NEAR(flat.emission().radiance * 0.25f * kPi, 2.0 * flux, 1e-3 * flux);
}

TEST(IntensityProfile, KnotsAndBetween) {
  const IntensityProfile p(table({0.0f, 1.0f, kPi}, {0.0f, 0.5f * kPi, kPi, 1.5f * kPi, kTwoPi},
                                 {5, 1, 0, 5, 2, 0, 5, 3, 0, 5, 4, 0, 5, 1, 0}));
  const Frame frame(kNormal);
  const auto at = [&](float theta, float phi) {
    return p(frame.to_world(
        {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}));
  };
  EXPECT_NEAR(at(0.0f, 0.0f), 5.0f, 1e-4f);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(at(1.0f, 0.5f * kPi * static_cast<float>(k)), static_cast<float>(k + 1), 1e-3f);
  }
  EXPECT_NEAR(at(1.0f, 0.25f * kPi), 1.5f, 1e-4f);
  EXPECT_NEAR(at(0.5f, 0.25f * kPi), 3.25f, 1e-4f);
  EXPECT_NEAR(at(1.0f, 1.75f * kPi), 2.5f, 1e-4f);
  EXPECT_NEAR(at(kPi, 0.0f), 0.0f, 1e-4f);
}

// A uniform hemisphere: 2 pi; a table that ends is dark beyond.
TEST(IntensityProfile, FluxAndRim) {
  const IntensityProfile p(table({0.0f, 0.5f * kPi}, {0.0f}, {1, 1}));
  EXPECT_NEAR(p.flux(), 2.0 * kPiD, 1e-6);
  EXPECT_EQ(p(kNormal), 1.0f);
  EXPECT_EQ(p(-kNormal), 0.0f);
  EXPECT_EQ(p(Frame(kNormal).to_world(normalized({1, 0, -0.001f}))), 0.0f);
}

TEST(IntensityProfile, RefusesNonsense) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& bad :
       {table({0.0f}, {0.0f}, {1}), table({0.0f, 1.0f}, {}, {}), table({0.0f, 1.0f}, {0.0f}, {1}),
        table({1.0f, 0.5f}, {0.0f}, {1, 1}), table({0.0f, 3.2f}, {0.0f}, {1, 1}),
        table({0.0f, nan}, {0.0f}, {1, 1}), table({0.0f, 1.0f}, {0.0f}, {1, -1}),
        table({0.0f, 1.0f}, {0.0f}, {1, nan})}) {
    EXPECT_THROW(IntensityProfile{bad}, std::invalid_argument);
  }
  auto skew = table({0.0f, 1.0f}, {0.0f}, {1, 1});
  skew.zero = skew.axis;
  EXPECT_THROW(IntensityProfile{skew}, std::invalid_argument);
  EXPECT_THROW(luminaire(CosinePowerProfile{-1.0f}), std::invalid_argument);
  const IntensityProfile good(table({0.0f, 1.0f}, {0.0f}, {1, 1}));
  EXPECT_THROW(luminaire(IntensityLamp{good, 0.0f, true}), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

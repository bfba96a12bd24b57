#include "media/altitude_density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "majorant_checks.h"
#include "pdfs/directions.h"

namespace nocturne {
namespace {

constexpr float kForever = std::numeric_limits<float>::infinity();
constexpr double kEarth = 6'371'000.0;
const Ground kFlat{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.0};
const Ground kPlanet{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, kEarth};

TEST(Ground, AltitudeIsRightToAMicrometreBesideAPlanet) {
  const Double3 up{0.6, -0.48, 0.64};
  const Ground ground{{1.5, 2.5, -3.5}, up, kEarth};
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    const auto u = test::media_numbers(i, 1);
    const float size = std::pow(10.0f, -3.0f + 8.0f * u[2]);  // 1 mm to 100 km
    const Vec3 p = size * UniformSphere::sample(u[0], u[1]);
    // By the distance to the centre, with 64 bits.
    const long double x = p.x - 1.5L + kEarth * 0.6L, y = p.y - 2.5L - kEarth * 0.48L,
                      z = p.z + 3.5L + kEarth * 0.64L;
    const long double expected = std::sqrt(x * x + y * y + z * z) - kEarth;
    EXPECT_NEAR(ground.altitude(p), static_cast<double>(expected), 1e-9 + 1e-14 * size) << size;
  }
}

TEST(Ground, AltitudeFallsAndRisesWhereItSays) {
  for (const Ground& ground : {kFlat, kPlanet}) {
    for (std::uint32_t i = 0; i < 2'000; ++i) {
      const auto u = test::media_numbers(i, 2), v = test::media_numbers(i, 3);
      const float size = std::pow(10.0f, -3.0f + 9.0f * u[2]);
      const Vec3 d = UniformSphere::sample(v[0], v[1]);
      const Double3 o(size * UniformSphere::sample(u[0], u[1]));
      const AltitudeAlong along(ground, o, d);
      const double t = static_cast<double>(size * 3.0f * u[3]), h = along(t);
      const double expected = ground.altitude(o + t * Double3(d));
      EXPECT_NEAR(h, expected, 1e-9 * (1.0 + static_cast<double>(size)));
      const double back = t < along.lowest() ? along.falls_to(h) : along.rises_to(h);
      ASSERT_TRUE(std::isfinite(back));
      EXPECT_NEAR(along(back), h, 1e-8 * (1.0 + static_cast<double>(size)));
    }
  }
}

float at(const AltitudeDensity& density, Vec3 p) {
  return AltitudeMajorants(density, {p, {1, 0, 0}}, 1.0f).density(0.0f);
}

TEST(AltitudeDensity, FollowsItsFormula) {
  const auto air = AltitudeDensity::exponential(kPlanet, 8'000.0);
  EXPECT_FLOAT_EQ(at(air, {0, 0, 0}), 1.0f);
  EXPECT_FLOAT_EQ(at(air, {0, 0, 8'000}), std::exp(-1.0f));
  EXPECT_FLOAT_EQ(at(air, {0, 0, -400}), std::exp(0.05f));
  // 10 km along the ground, the planet falls away by 7.848 m.
  EXPECT_NEAR(at(air, {10'000, 0, 0}), std::exp(-7.848 / 8'000.0), 1e-7);
  EXPECT_EQ(at(air, {0, 0, 1e6f}), 0.0f);
  // A millimetre on a planet.
  const auto film = AltitudeDensity::exponential(kPlanet, 1e-3);
  EXPECT_FLOAT_EQ(at(film, {0, 0, 1e-3f}), std::exp(-1.0f));
  EXPECT_FLOAT_EQ(at(film, {0.5f, 0.0f, 2e-3f}),
                  static_cast<float>(std::exp(-(2e-3 + 0.125 / kEarth) / 1e-3)));

  const auto layer = AltitudeDensity::table(kFlat, {1.0, 2.0, 4.0}, {0.0f, 3.0f, 1.0f});
  EXPECT_EQ(at(layer, {5, 5, 0.99f}), 0.0f);
  EXPECT_FLOAT_EQ(at(layer, {5, 5, 1.5f}), 1.5f);
  EXPECT_FLOAT_EQ(at(layer, {5, 5, 3.0f}), 2.0f);
  EXPECT_FLOAT_EQ(at(layer, {5, 5, 4.0f}), 1.0f);
  EXPECT_EQ(at(layer, {5, 5, 4.01f}), 0.0f);
}

std::vector<AltitudeDensity> several() {
  std::vector<AltitudeDensity> all;
  for (const Ground& ground : {kFlat, kPlanet, Ground{{3.0, -2.0, 1.0}, {1.0, 2.0, -2.0}, 0.0},
                               Ground{{0.001, 0.002, 0.003}, {1.0, 1.0, 1.0}, 1'737'400.0},
                               Ground{{0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.5}}) {
    for (const double height : {8'000.0, 1.0, 1e-3}) {
      all.push_back(AltitudeDensity::exponential(ground, height));
    }
    all.push_back(AltitudeDensity::table(ground, {10e3, 25e3, 40e3}, {0.0f, 1.0f, 0.0f}));
    // Gaps, steps, and ends that are not zero.
    all.push_back(AltitudeDensity::table(ground, {-1.0, 0.0, 1e-4, 0.2, 0.3, 1.0, 2.0},
                                         {3.0f, 0.0f, 0.0f, 0.0f, 5.0f, 5.0f, 2.0f}));
    std::vector<double> knots;
    std::vector<float> values;
    for (int i = 0; i < 2'000; ++i) {
      knots.push_back(1e-3 * i * i);
      values.push_back(test::media_numbers(static_cast<std::uint32_t>(i), 4)[0]);
    }
    all.push_back(AltitudeDensity::table(ground, knots, values));
  }
  return all;
}

TEST(AltitudeMajorants, HoldOnAnyRay) {
  std::uint32_t i = 0;
  for (const AltitudeDensity& density : several()) {
    for (int ray = 0; ray < 150; ++ray, ++i) {
      const auto u = test::media_numbers(i, 5), v = test::media_numbers(i, 6);
      const float size = std::pow(10.0f, -4.0f + 10.0f * u[2]);
      const Vec3 o = size * UniformSphere::sample(u[0], u[1]);
      Vec3 d = UniformSphere::sample(v[0], v[1]);
      if (ray % 5 == 0) d = {1.0f, 0.0f, 0.0f};
      if (ray % 5 == 1) d = normalized(Vec3{v[0] - 0.5f, v[1] - 0.5f, 1e-4f * (v[2] - 0.5f)});
      const float end = v[3] < 0.2f ? kForever : std::pow(10.0f, -4.0f + 11.0f * u[3]);
      SCOPED_TRACE(i);
      test::expect_bounds_hold(density, {o, d}, end, i);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(AltitudeMajorants, AreCloseEnoughToPay) {
  const auto air = AltitudeDensity::exponential(kPlanet, 8'000.0);
  for (const double degrees : {0.0, 60.0, 85.0, 90.0}) {
    const double angle = degrees * std::acos(-1.0) / 180.0;
    const Vec3 up{static_cast<float>(std::sin(angle)), 0.0f, static_cast<float>(std::cos(angle))};
    EXPECT_LT(test::waste(air, {{0, 0, 1.7f}, up}, 1e7f), 1.6) << degrees;
    const Vec3 sky = 9e5f * up;
    EXPECT_LT(test::waste(air, {sky, -up}, 9e5f), 1.6) << degrees;
    EXPECT_LE(test::segments(air, {{0, 0, 1.7f}, up}, kForever).size(), 16u);
  }
  const auto ozone = AltitudeDensity::table(kPlanet, {10e3, 25e3, 40e3}, {0.0f, 1.0f, 0.0f});
  EXPECT_LT(test::waste(ozone, {{0, 0, 0}, {0, 0, 1}}, 1e5f), 2.1);
  EXPECT_EQ(test::segments(ozone, {{0, 0, 0}, {0, 0, 1}}, 9e3f).size(), 1u);
  std::vector<double> knots;
  std::vector<float> values;
  for (int i = 0; i <= 10'000 - 1; ++i) {
    knots.push_back(10.0 * i);
    values.push_back(std::exp(-10.0f * static_cast<float>(i) / 8'000.0f));
  }
  const auto table = AltitudeDensity::table(kPlanet, knots, values);
  EXPECT_LT(test::waste(table, {{0, 0, 0}, {0, 0, 1}}, 1e6f), 1.5);
  EXPECT_LE(test::segments(table, {{0, 0, 0}, {0, 0, 1}}, 1e6f).size(), 40u);
}

// From so far that a position in single precision knows its altitude to two scale heights.
TEST(AltitudeMajorants, AreCloseFarAway) {
  constexpr double kHeight = 2.4;
  const auto fog = AltitudeDensity::exponential(kFlat, kHeight);
  for (const Vec3 d :
       {Vec3{0.8f, 0.0f, -0.6f}, Vec3{0.0f, 0.0f, -1.0f}, Vec3{-0.6f, 0.64f, -0.48f}}) {
    const Ray ray{-6e7f * d, d};
    const AltitudeAlong altitude(kFlat, ray.origin, ray.direction);
    double from = 0.0, bounded = 0.0, there = 0.0;
    for (const MajorantSegment& s : test::segments(fog, ray, 6.0000004e7f)) {
      const double to = static_cast<double>(s.end);
      bounded += static_cast<double>(s.majorant) * (to - from);
      there += kHeight / -static_cast<double>(d.z) *
               (std::exp(-altitude(to) / kHeight) - std::exp(-altitude(from) / kHeight));
      from = to;
    }
    EXPECT_LT(bounded, 4.0 * there) << d.z;
    EXPECT_GE(bounded, there) << d.z;
  }
}

// Along the fog without end: each bound is the density there, though rounding could become
// arbitrarily large.
TEST(AltitudeMajorants, StayLowOnLevelRays) {
  const auto fog = AltitudeDensity::exponential(kFlat, 10.0);
  for (const auto& s : test::segments(fog, {{0, 0, 5}, {1, 0, 0}}, kForever)) {
    EXPECT_LE(s.majorant, 1.001f);
  }
}

// Where a body's face lies in the plane where a layer ends, photons start a rounding above it.
TEST(AltitudeMajorants, EndBesideTheStartOfARayThatLeavesAllLayers) {
  const auto layers = AltitudeDensity::table(kFlat, {0.3, 1.0, 3.0}, {1.0f, 0.4f, 0.2f});
  float height = 3.0f;
  for (int i = 0; i < 8; ++i, height = std::nextafter(height, 4.0f)) {
    AltitudeMajorants along(layers, {{1.0f, 2.0f, height}, {0.6f, 0.0f, 0.8f}}, kForever);
    float from = 0.0f, bounded = 0.0f;
    for (MajorantSegment segment; along.next(segment); from = segment.end) {
      if (segment.majorant > 0.0f) bounded += segment.end - from;
    }
    EXPECT_LT(bounded, 1e-4f) << i;
  }
}

// Where the lowest layer begins at height 0, nothing is rounded there: a ray that fell from its
// edge had the layer's bound without end, and took all tentative collisions that there may be.
TEST(AltitudeMajorants, EndWhereARayFallsFromTheLowestEdge) {
  const auto layers = AltitudeDensity::table(kFlat, {0.0, 2.0}, {1.0f, 0.5f});
  const Ground along_y{{0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.0};
  const auto above_y = AltitudeDensity::table(along_y, {0.0, 2.0}, {1.0f, 0.5f});
  const auto bounded = [](const AltitudeDensity& density, const Ray& ray) {
    AltitudeMajorants along(density, ray, kForever);
    float from = 0.0f, all = 0.0f;
    for (MajorantSegment segment; along.next(segment); from = segment.end) {
      if (segment.majorant > 0.0f) all += segment.end - from;
    }
    return all;
  };
  EXPECT_LT(bounded(layers, {{1.0f, 2.0f, 0.0f}, {0.6f, 0.0f, -0.8f}}), 1e-4f);
  EXPECT_LT(bounded(above_y, {{1.0f, 0.0f, 2.0f}, {0.6f, -0.8f, 0.0f}}), 1e-4f);
  EXPECT_EQ(bounded(layers, {{1.0f, 2.0f, 0.0f}, {1.0f, 0.0f, 0.0f}}), kForever);
}

TEST(ConstantDensity, IsOneSegment) {
  const ConstantDensity density{0.5f};
  const auto s = test::segments(density, {{1, 2, 3}, {0, 0, 1}}, 7.0f);
  ASSERT_EQ(s.size(), 1u);
  EXPECT_EQ(s[0].majorant, 0.5f);
  EXPECT_EQ(ConstantMajorants(density, {{1, 2, 3}, {0, 0, 1}}, 7.0f).density(2.0f), 0.5f);
}

TEST(AltitudeDensity, RefusesWhatIsNone) {
  const double nan = std::nan("");
  const auto refused = [](const Ground& ground, double height) {
    EXPECT_THROW(AltitudeDensity::exponential(ground, height), std::invalid_argument);
  };
  for (const double height : {0.0, -1.0, nan, HUGE_VAL}) refused(kFlat, height);
  refused({{nan, 0, 0}, {0, 0, 1}, 0.0}, 1.0);
  refused({{0, 0, 0}, {0, 0, 0}, 0.0}, 1.0);
  refused({{0, 0, 0}, {0, 0, 1}, -1.0}, 1.0);
  refused({{0, 0, 0}, {0, 0, 1}, nan}, 1.0);
  const auto no_table = [](std::vector<double> altitudes, std::vector<float> densities) {
    EXPECT_THROW(AltitudeDensity::table(kFlat, std::move(altitudes), std::move(densities)),
                 std::invalid_argument);
  };
  no_table({}, {});
  no_table({1.0}, {1.0f});
  no_table({1.0, 2.0}, {1.0f});
  no_table({2.0, 1.0}, {1.0f, 1.0f});
  no_table({1.0, nan}, {1.0f, 1.0f});
  no_table({1.0, 2.0}, {1.0f, -1.0f});
  no_table({1.0, 2.0}, {1.0f, std::nanf("")});
  no_table(std::vector<double>(10'001, 1.0), std::vector<float>(10'001, 1.0f));
}

}  // namespace
}  // namespace nocturne

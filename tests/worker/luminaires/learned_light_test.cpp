// Where light was learned to come from.
#include "luminaires/learned_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "support/chi_square.h"

namespace nocturne {
namespace {

using Arrival = LearnedLight::Arrival;

Uniform4 numbers(std::uint32_t i) {
  PixelSequence pixel(SequenceKind::kIndependent, 7, 0);
  return PhotonSequence(pixel, i).next();
}

/// On a floor and, fewer, on a wall: from a spot above, and from one to the side.
std::vector<Arrival> arrivals(std::uint32_t count) {
  std::vector<Arrival> all;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Uniform4 u = numbers(2 * i), v = numbers(2 * i + 1);
    const Vec3 place = i % 8 == 0 ? Vec3{0.0f, u[0], u[1]} : Vec3{u[0], u[1], 0.0f};
    const Vec3 spot = u[2] < 0.3f ? Vec3{3.0f, 0.5f, 1.0f} : Vec3{0.5f, 0.5f, 2.0f};
    const Vec3 around{0.1f * v[0], 0.1f * v[1], 0.1f * v[2]};
    all.push_back({place, normalized(spot + around - place)});
  }
  return all;
}

TEST(LearnedLight, DrawsWhatItsDensitySays) {
  const LearnedLight light(arrivals(2000));
  for (const Vec3 place :
       {Vec3{0.2f, 0.7f, 0.0f}, Vec3{0.9f, 0.1f, 0.0f}, Vec3{0.0f, 0.4f, 0.3f}}) {
    const std::uint32_t cell = light.find(place);
    ASSERT_NE(cell, LearnedLight::kNone);
    test::expect_samples_match_pdf(
        [&](const Uniform4& u) { return std::optional(light.sample(cell, u[0], u[1], u[2])); },
        [&](Vec3 w) { return light.pdf(cell, w); });
  }
}

TEST(LearnedLight, SunsAreNarrow) {
  std::vector<Arrival> all;
  const Vec3 sun = normalized({0.3f, 0.2f, 0.9f});
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Uniform4 u = numbers(i);
    const Vec3 around{0.005f * u[2], 0.005f * u[3], 0.0f};
    all.push_back({{u[0], u[1], 0.0f}, normalized(sun + around)});
  }
  const LearnedLight light(all);
  const std::uint32_t cell = light.find({0.5f, 0.5f, 0.0f});
  ASSERT_NE(cell, LearnedLight::kNone);
  double mean = 0.0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const Uniform4 u = numbers(i);
    const float pdf = light.pdf(cell, light.sample(cell, u[0], u[1], u[2]));
    // Every drawn direction has a density, and that of a narrow cone.
    ASSERT_GT(pdf, 100.0f);
    mean += 1.0 / static_cast<double>(pdf) / 4000.0;
  }
  // The solid angle of all cones together: some times that of the spot.
  EXPECT_GT(mean, 2.5e-5);
  EXPECT_LT(mean, 5e-4);
}

// Most places have one coordinate in common: those on a floor. Each finds a cell of its
// neighbourhood, with light from the direction of its arrival.
TEST(LearnedLight, PlacesOnAPlaneFindTheirNeighbours) {
  const auto all = arrivals(4000);
  const LearnedLight light(all);
  std::size_t narrow = 0;
  for (const Arrival& each : all) {
    const std::uint32_t cell = light.find(each.position);
    ASSERT_NE(cell, LearnedLight::kNone);
    EXPECT_GT(light.pdf(cell, each.direction), 0.0f);
    narrow += light.pdf(cell, each.direction) > 10.0f ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(narrow), 0.8 * static_cast<double>(all.size()));
}

// A cone's solid angle is 2 pi (1 - cos of half its angle).
TEST(LearnedLight, DensityIsThatOfItsCones) {
  const LearnedLight light(arrivals(2000));
  const std::uint32_t cell = light.find({0.5f, 0.5f, 0.0f});
  const auto cones = light.cones(cell);
  ASSERT_GE(cones.size(), 8u);
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Uniform4 u = numbers(i);
    const Vec3 direction = light.sample(cell, u[0], u[1], u[2]);
    double expected = 0.0;
    for (const auto& [axis, half_angle] : cones) {
      const double half = static_cast<double>(half_angle);
      const double angle = 2.0 * std::asin(0.5 * static_cast<double>(length(direction - axis)));
      if (std::fabs(angle / half - 1.0) < 1e-3) expected = -1e30;  // on a rim
      if (angle <= half) expected += 1.0 / (2.0 * std::numbers::pi * (1.0 - std::cos(half)));
    }
    if (expected < 0.0) continue;
    expected /= static_cast<double>(cones.size());
    EXPECT_NEAR(static_cast<double>(light.pdf(cell, direction)) / expected, 1.0, 1e-3);
  }
}

TEST(LearnedLight, TellsNothingElsewhere) {
  EXPECT_TRUE(LearnedLight().empty());
  EXPECT_EQ(LearnedLight().find({0, 0, 0}), LearnedLight::kNone);
  EXPECT_TRUE(LearnedLight(arrivals(7)).empty());
  const LearnedLight light(arrivals(2000));
  EXPECT_EQ(light.find({0.5f, 0.5f, 9.0f}), LearnedLight::kNone);
  EXPECT_EQ(light.find({-4.0f, 0.5f, 0.0f}), LearnedLight::kNone);
  EXPECT_EQ(light.pdf(light.find({0.5f, 0.5f, 0.0f}), {0, 0, -1}), 0.0f);
}

TEST(LearnedLight, AllAtOnePlace) {
  std::vector<Arrival> all;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Uniform4 u = numbers(i);
    all.push_back({{1, 2, 3}, UniformSphere::sample(u[0], u[1])});
  }
  const LearnedLight light(all);
  const std::uint32_t cell = light.find({1, 2, 3});
  ASSERT_NE(cell, LearnedLight::kNone);
  EXPECT_GT(light.pdf(cell, light.sample(cell, 0.4f, 0.3f, 0.2f)), 0.0f);
}

// Of a floor and one place above it.
TEST(LearnedLight, FewOnOneSideTellNothing) {
  for (const std::uint32_t few : {1u, 2u, 7u}) {
    std::vector<Arrival> all;
    for (std::uint32_t i = 0; i < 200; ++i) {
      const Uniform4 u = numbers(i);
      all.push_back({{0.01f * u[0], 0.01f * u[1], i < few ? 5.0f : 0.0f}, {0, 0, 1}});
    }
    const LearnedLight light(all);
    EXPECT_EQ(light.find(all.front().position), LearnedLight::kNone);
    EXPECT_NE(light.find(all.back().position), LearnedLight::kNone);
  }
}

TEST(LearnedLight, IsPackedAndUnpacked) {
  const auto all = arrivals(100);
  const std::string bytes = LearnedLight::packed(all);
  EXPECT_EQ(bytes.size(), 1600u);
  const auto again = LearnedLight::unpacked(bytes);
  ASSERT_EQ(again.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(again[i].position.x, all[i].position.x);
    EXPECT_EQ(again[i].position.y, all[i].position.y);
    EXPECT_EQ(again[i].position.z, all[i].position.z);
    EXPECT_LT(length(again[i].direction - all[i].direction), 1e-4f);
    EXPECT_NEAR(length(again[i].direction), 1.0f, 1e-6f);
  }
}

TEST(LearnedLight, RefusesWhatIsNoList) {
  EXPECT_THROW(LearnedLight::unpacked(std::string(15, 'a')), std::invalid_argument);
  EXPECT_THROW(LearnedLight::unpacked(std::string(16 * 65'537, '\0')), std::invalid_argument);
  // A float32 that is not a number.
  EXPECT_THROW(LearnedLight::unpacked(std::string(16, '\xff')), std::invalid_argument);
  // A step beyond the octahedron's square is taken for its edge.
  const std::string edge("\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\0\x80", 16);
  EXPECT_NEAR(length(LearnedLight::unpacked(edge).front().direction), 1.0f, 1e-6f);
}

}  // namespace
}  // namespace nocturne

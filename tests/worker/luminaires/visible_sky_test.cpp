// Which part of the sky is visible from where.
#include "luminaires/visible_sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include "pdfs/directions.h"
#include "support/chi_square.h"

namespace nocturne {
namespace {

using Sighting = VisibleSky::Sighting;

Uniform4 numbers(std::uint32_t i) {
  PixelSequence pixel(SequenceKind::kIndependent, 11, 0);
  return PhotonSequence(pixel, i).next();
}

/// On a floor, by a window at x = 0, and on a wall across, now and then anywhere.
std::vector<Sighting> sightings(std::uint32_t count) {
  std::vector<Sighting> all;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Uniform4 u = numbers(2 * i), v = numbers(2 * i + 1);
    const bool wall = i % 4 == 0;
    const Vec3 place =
        wall ? Vec3{4.0f, 4.0f * u[0], 2.0f * u[1]} : Vec3{4.0f * u[0], 4.0f * u[1], 0.0f};
    const Vec3 normal = wall ? Vec3{-1.0f, 0.0f, 0.0f} : Vec3{0.0f, 0.0f, 1.0f};
    const Vec3 window{0.0f, 1.0f + v[0], 1.0f + v[1]};
    const Vec3 to = v[2] < 0.1f ? UniformSphere::sample(v[3], u[2]) : normalized(window - place);
    all.push_back(VisibleSky::sighting(place, normal, to, 0.5f + u[3]));
  }
  return all;
}

TEST(VisibleSky, DrawsWhatItsDensitySays) {
  const VisibleSky sky(sightings(3000));
  for (const auto& [place, normal] : {std::pair{Vec3{0.5f, 1.5f, 0.0f}, Vec3{0, 0, 1}},
                                      {{3.5f, 3.0f, 0.0f}, {0.1f, 0, 0.9f}},
                                      {{4.0f, 2.0f, 1.0f}, {-1, 0, 0}}}) {
    const std::uint32_t cell = sky.find(place, normal);
    ASSERT_NE(cell, VisibleSky::kNone);
    test::expect_samples_match_pdf(
        [&](const Uniform4& u) { return std::optional(sky.sample(cell, u[0], u[1])); },
        [&](Vec3 w) { return sky.pdf(cell, w); });
  }
}

TEST(VisibleSky, MostDirectionsGoThroughTheWindow) {
  const VisibleSky sky(sightings(8000));
  for (const Vec3 place :
       {Vec3{1.0f, 1.5f, 0.0f}, Vec3{2.0f, 2.5f, 0.0f}, Vec3{3.0f, 1.0f, 0.0f}}) {
    const std::uint32_t cell = sky.find(place, {0, 0, 1});
    std::uint32_t through = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const Uniform4 u = numbers(i);
      const Vec3 d = sky.sample(cell, u[0], u[1]);
      ASSERT_NEAR(length(d), 1.0f, 1e-5f);
      const Vec3 at = place + (-place.x / d.x) * d;
      // Bins are up to half a metre wide at the window.
      through += d.x < 0.0f && std::fabs(at.y - 1.5f) < 1.0f && std::fabs(at.z - 1.5f) < 1.0f;
    }
    EXPECT_GT(through, 1200u) << place.x;
  }
}

TEST(VisibleSky, KnowsWhichSideASurfaceFaces) {
  const VisibleSky sky(sightings(3000));
  EXPECT_EQ(sky.find({1.0f, 1.0f, 3.0f}, {0, 0, -1}), VisibleSky::kNone);
  EXPECT_EQ(sky.find({0.0f, 1.0f, 1.0f}, {1, 0, 0}), VisibleSky::kNone);
  EXPECT_NE(sky.find({1.0f, 1.0f, 0.0f}, {0.5f, 0.5f, 0.7f}), VisibleSky::kNone);
  EXPECT_EQ(VisibleSky().find({0, 0, 0}, {0, 0, 1}), VisibleSky::kNone);
  EXPECT_TRUE(VisibleSky(sightings(7)).empty());
}

TEST(VisibleSky, IsPackedAndUnpacked) {
  const auto all = sightings(500), again = VisibleSky::unpacked(VisibleSky::packed(all));
  ASSERT_EQ(again.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(length(all[i].position - again[i].position), 0.0f);
    EXPECT_EQ(all[i].side, again[i].side);
    EXPECT_EQ(all[i].bin, again[i].bin);
    EXPECT_NEAR(again[i].worth, all[i].worth, 0.01f * all[i].worth);
  }
  EXPECT_EQ(VisibleSky::packed(again), VisibleSky::packed(all));
}

TEST(VisibleSky, RefusesWhatIsNone) {
  std::string bytes = VisibleSky::packed(sightings(20));
  EXPECT_THROW(VisibleSky::unpacked(bytes.substr(1)), std::invalid_argument);
  EXPECT_THROW(VisibleSky::unpacked(std::string(16 * (VisibleSky::kMaxSightings + 1), '\0')),
               std::invalid_argument);
  const auto refused = [&](std::size_t at, auto value) {
    std::string damaged = bytes;
    std::memcpy(&damaged[at], &value, sizeof(value));
    EXPECT_THROW(VisibleSky::unpacked(damaged), std::invalid_argument);
  };
  refused(4, std::numeric_limits<float>::quiet_NaN());
  refused(16, std::numeric_limits<float>::infinity());
  refused(12, std::uint16_t{6 * 512});
  refused(14, std::uint16_t{0x7F80});
  refused(14, std::uint16_t{0xBF80});
}

// All at one place, on one plane, and in one direction.
TEST(VisibleSky, TakesManySightingsOfOnePlace) {
  std::vector<Sighting> all(5000, VisibleSky::sighting({1, 2, 3}, {0, 1, 0}, {0, 1, 0}, 1e-30f));
  const VisibleSky sky(all);
  const std::uint32_t cell = sky.find({1, 2, 3}, {0, 1, 0});
  ASSERT_NE(cell, VisibleSky::kNone);
  EXPECT_GT(sky.pdf(cell, normalized({0.01f, 1.0f, 0.01f})), 1.0f);
}

}  // namespace
}  // namespace nocturne

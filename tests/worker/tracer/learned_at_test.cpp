// Learned light for display: the place that a pixel shows, directly and by glass.
#include "tracer/learning/learned_at.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/caustic_scene.h"

namespace nocturne {
namespace {

constexpr Film kFilm{9, 9};

/// On the floor, all by one direction.
LearnedLight from_the_left() {
  std::vector<LearnedLight::Arrival> arrivals;
  for (int i = 0; i < 400; ++i) {
    const auto x = static_cast<float>(i % 20 - 10), z = static_cast<float>(i / 20 - 10);
    arrivals.push_back({{0.2f * x, -1.0f, 0.2f * z}, {-0.6f, 0.8f, 0.0f}});
  }
  return LearnedLight(arrivals);
}

TEST(LearnedAt, TellsOfTheFloorWhatWasLearnedThere) {
  const auto scene = test::floor_and_lamp(false).load();
  scene->lights.set_learned(from_the_left());
  const auto found = learned_at(*scene, kFilm, 4, 4);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->passed, 0u);
  EXPECT_NEAR(found->normal.y, 1.0f, 1e-6f);
  // From (0, 1, 3) to (0, -1, -0.5).
  EXPECT_LT(length(found->direction - (1.0f / std::sqrt(16.25f)) * Vec3{0, -2, -3.5f}), 1e-5f);
  ASSERT_GE(found->cones.size(), 8u);
  for (const auto& [axis, half_angle] : found->cones) {
    EXPECT_NEAR(axis.x, -0.6f, 1e-3f);
    EXPECT_LT(half_angle, 0.01f);
  }
}

// The ball covers the middle: in and out again are two boundaries.
TEST(LearnedAt, LooksThroughGlass) {
  test::SceneBuilder builder = test::floor_and_lamp(true);
  builder.look({0, 3.5f, 1}, {0, -0.3f, -0.5f}, 0.2);
  const auto scene = builder.load();
  const auto found = learned_at(*scene, kFilm, 4, 4);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->passed, 2u);
  EXPECT_NEAR(found->normal.y, 1.0f, 1e-6f);
}

TEST(LearnedAt, HasNoConesWhereNothingWasLearned) {
  const auto scene = test::floor_and_lamp(false).load();
  const auto found = learned_at(*scene, kFilm, 4, 4);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->cones.empty());
}

TEST(LearnedAt, IsEmptyWhereNoSurfaceIsSeen) {
  test::SceneBuilder builder = test::floor_and_lamp(false);
  builder.look({0, 1, 3}, {0, 9, 3.5f}, 0.2);
  EXPECT_FALSE(learned_at(*builder.load(), kFilm, 4, 4));
}

}  // namespace
}  // namespace nocturne

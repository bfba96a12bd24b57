// Learned targets for photons from luminaires, and learned light that mirrors and glass focus. That
// images stay the same with any targets and guides is tested in tests/accuracy.
#include "tracer/learning/learn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/caustic_scene.h"
#include "tracer/learning/aims_around.h"
#include "tracer/learning/gatherers.h"

namespace nocturne {
namespace {

/// So many on a sphere, evenly.
std::vector<Vec3> on_a_sphere(Vec3 centre, float radius, int count) {
  std::vector<Vec3> places;
  for (int i = 0; i < count; ++i) {
    const auto z = static_cast<float>((2 * i + 1) / (1.0 * count) - 1.0);
    const float across = std::sqrt(1.0f - z * z);
    const auto turn = static_cast<float>(i * std::numbers::pi * (3.0 - std::sqrt(5.0)));
    places.push_back(centre + radius * Vec3{across * std::cos(turn), across * std::sin(turn), z});
  }
  return places;
}

bool holds(const Aim& aim, Vec3 place) { return length(place - aim.centre) <= aim.radius; }

TEST(AimsAround, OneBallAreAllPlacesOnIt) {
  const std::vector<Aim> aims = aims_around(on_a_sphere({1, 2, 3}, 0.5f, 500));
  ASSERT_EQ(aims.size(), 1u);
  EXPECT_LT(length(aims[0].centre - Vec3{1, 2, 3}), 0.01f);
  EXPECT_GT(aims[0].radius, 0.499f);  // a ball's places are all at its edge
  EXPECT_LT(aims[0].radius, 0.55f);
}

TEST(AimsAround, TwoBallsFarFromEachOtherAreTwo) {
  std::vector<Vec3> places = on_a_sphere({-3, 0, 0}, 0.5f, 400);
  const std::vector<Vec3> others = on_a_sphere({3, 0, 0}, 0.25f, 400);
  places.insert(places.end(), others.begin(), others.end());
  const std::vector<Aim> aims = aims_around(places);
  ASSERT_EQ(aims.size(), 2u);
  const auto missed = std::ranges::count_if(places, [&](Vec3 place) {
    return std::ranges::none_of(aims, [&](const Aim& aim) { return holds(aim, place); });
  });
  EXPECT_LE(missed, 8);  // one of a hundred
  // As many places, half as wide.
  EXPECT_NEAR(std::max(aims[0].weight, aims[1].weight) / std::min(aims[0].weight, aims[1].weight),
              2.0, 0.05);
}

TEST(AimsAround, AFewFarPlacesDoNotMakeABallWide) {
  std::vector<Vec3> places = on_a_sphere({0, 0, 0}, 0.5f, 1000);
  places.push_back({40, 0, 0});
  places.push_back({-50, 10, 0});
  const std::vector<Aim> aims = aims_around(places);
  ASSERT_EQ(aims.size(), 1u);
  EXPECT_LT(aims[0].radius, 0.6f);
}

TEST(AimsAround, OnePointIsNoBall) {
  EXPECT_TRUE(aims_around(std::vector<Vec3>(100, Vec3{1, 1, 1})).empty());
}

TEST(Learn, FindsTheBallThatMakesTheCaustic) {
  const auto scene = test::floor_and_lamp(true).load();
  const Learned learned = learn(*scene, {64, 48}, 1 << 15, 2);
  const std::vector<Aim> aims = aims_around(learned.worth_aiming_at);
  ASSERT_EQ(aims.size(), 1u);
  EXPECT_LT(length(aims[0].centre - Vec3{0, -0.3f, -0.5f}), 0.5f);
  EXPECT_LT(aims[0].radius, 1.0f);
  EXPECT_GT(learned.rays, 0u);
}

// Of the Sun, whose photons fall on all of the scene.
TEST(Learn, FindsTheBallInDistantLight) {
  test::SceneBuilder builder = test::floor_and_lamp(true);
  builder.message.clear_luminaires();
  auto& disc = *builder.message.add_distant_discs();
  test::SceneBuilder::set(*disc.mutable_direction(), {0, 1, 0});
  disc.set_half_angle(0.005);
  disc.set_radiance(builder.add_spectrum(1e4f));
  const Learned learned = learn(*builder.load(), {64, 48}, 1 << 15, 2);
  const std::vector<Aim> aims = aims_around(learned.worth_aiming_at);
  ASSERT_EQ(aims.size(), 1u);
  EXPECT_LT(length(aims[0].centre - Vec3{0, -0.3f, -0.5f}), 0.5f);
  EXPECT_LT(aims[0].radius, 0.6f);
}

TEST(Learn, FindsWhereTheBallGathersLight) {
  const auto scene = test::floor_and_lamp(true).load();
  const std::vector<LearnedLight::Arrival> arrivals = learn(*scene, {64, 48}, 1 << 15, 2).arrivals;
  ASSERT_GT(arrivals.size(), 50u);
  std::size_t below = 0;
  for (const auto& [position, direction] : arrivals) {
    EXPECT_NEAR(position.y, -1.0f, 1e-4f);
    EXPECT_GT(direction.y, 0.0f);
    below += length(position - Vec3{0, -1, -0.5f}) < 0.5f ? 1u : 0u;
  }
  EXPECT_GT(below, arrivals.size() / 2);
}

TEST(Learn, FindsWhatIsGatheredInMedia) {
  test::SceneBuilder builder = test::floor_and_lamp(true);
  const std::uint32_t none = builder.add_spectrum(0.0f), some = builder.add_spectrum(0.3f);
  builder.add_unbounded({builder.add_medium(none, some, 0.0)});
  const std::vector<LearnedLight::Arrival> arrivals =
      learn(*builder.load(), {64, 48}, 1 << 15, 2).arrivals;
  std::size_t in_media = 0;
  for (const auto& [position, direction] : arrivals) {
    if (position.y < -0.99f) continue;
    ++in_media;
    // By the ball alone: from the lamp they come directly, too.
    const Vec3 to_ball = Vec3{0, -0.3f, -0.5f} - position;
    const float along = dot(to_ball, direction);
    EXPECT_LT(length(to_ball - along * direction), 0.501f);
  }
  EXPECT_GT(in_media, 10u);
  EXPECT_LT(in_media, arrivals.size());
}

TEST(Learn, IsTheSameOnAnyNumberOfThreadsAndLeavesTheSceneAsItWas) {
  const auto scene = test::floor_and_lamp(true).load();
  const std::uint64_t seed = scene->options.seed;
  const Learned one = learn(*scene, {64, 48}, 1 << 16, 1);
  const Learned three = learn(*scene, {64, 48}, 1 << 16, 3);
  EXPECT_EQ(scene->options.seed, seed);
  EXPECT_EQ(one.rays, three.rays);
  EXPECT_EQ(one.worth_aiming_at, three.worth_aiming_at);
  EXPECT_EQ(LearnedLight::packed(one.arrivals), LearnedLight::packed(three.arrivals));
}

TEST(Learn, AsksNothingWhereNoMirrorOrGlassGathersLight) {
  test::SceneBuilder builder = test::floor_and_lamp(false);
  builder.message.mutable_tracing()->set_direction(v1::DIRECTION_BOTH);
  const Learned learned = learn(*builder.load(), {64, 48}, 1 << 15, 2);
  EXPECT_TRUE(learned.worth_aiming_at.empty());
  EXPECT_TRUE(learned.arrivals.empty());
  EXPECT_EQ(learned.rays, 0u);
}

std::vector<Aim> aims_at_gatherers(const Scene& scene) {
  return aims_around(places_on_gatherers(scene, [](std::uint32_t) { return 0u; }));
}

// One photon of some hundreds that leave for a floor of 40 m meets a ball of 1 m.
TEST(Gatherers, AreABallOfGlassOnAWideFloor) {
  test::SceneBuilder builder = test::floor_and_lamp(true);
  builder.add_quad(0.5f, 0.0f, {-20, -1.1f, -20}, {0, 0, 40}, {40, 0, 0});
  const std::vector<Aim> aims = aims_at_gatherers(*builder.load());
  ASSERT_EQ(aims.size(), 1u);
  EXPECT_LT(length(aims[0].centre - Vec3{0, -0.3f, -0.5f}), 0.05f);
  EXPECT_GT(aims[0].radius, 0.499f);
  EXPECT_LT(aims[0].radius, 0.6f);
}

TEST(Gatherers, AreNotWhatIsDiffuseNorWhatIsAsWideAsTheScene) {
  EXPECT_TRUE(aims_at_gatherers(*test::floor_and_lamp(false).load()).empty());
  test::SceneBuilder builder = test::floor_and_lamp(false);
  test::add_glass_ball(builder, {0, 0, 0}, 40.0);
  EXPECT_TRUE(aims_at_gatherers(*builder.load()).empty());
}

}  // namespace
}  // namespace nocturne

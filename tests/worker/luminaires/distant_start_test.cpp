// Where photons of distant light enter a scene: draws against a density by its definition.
#include "luminaires/distant_start.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <vector>

#include "support/chi_square.h"

namespace nocturne {
namespace {

constexpr Geometry::Ball kScene{{1, 2, 3}, 5.0f};
constexpr float kAimed = 0.8f;
constexpr int kDraws = 200'000;

Uniform4 numbers(std::uint32_t i) {
  return to_unit(std::bit_cast<__m128i>(philox4x32({i, 0, 0, 0}, {5, 6})));
}

struct Aim {
  Vec3 centre;
  float radius, weight;
};

// Two that lie on each other's disc, and one at the edge of the scene's.
const std::vector<Aim> kAims{
    {{1, 2, 3}, 1.0f, 1.0f}, {{1.5f, 2.5f, 5}, 0.7f, 3.0f}, {{5.5f, 2, 1}, 1.2f, 2.0f}};

Elements elements(const std::vector<Aim>& aims) {
  Elements made;
  for (const Aim& aim : aims) {
    const Sphere ball{aim.centre.x, aim.centre.y, aim.centre.z, aim.radius};
    made.add_sphere(std::array{ball}, {.radiance = 1.0f});
    made.share_weight(made.size() - 1, aim.weight);
  }
  return made;
}

/// Across `towards`, on axes through the scene's middle.
std::array<double, 2> across(const Frame& frame, Vec3 place) {
  const Vec3 away = place - kScene.centre;
  return {dot(away, frame.tangent), dot(away, frame.bitangent)};
}

// Smaller than the scene, and beside its middle.
constexpr Geometry::Ball kReached{{2, 0.5f, 2.5f}, 2.0f};

double density(const Frame& frame, double x, double y, const Geometry::Ball& whole = kScene) {
  const auto disc = [&](const Vec3 centre, double radius) {
    const auto [u, v] = across(frame, centre);
    const bool inside = (x - u) * (x - u) + (y - v) * (y - v) <= radius * radius;
    return inside ? 1.0 / (std::numbers::pi * radius * radius) : 0.0;
  };
  double aimed = 0.0, weights = 0.0;
  for (const Aim& aim : kAims) {
    aimed += aim.weight * disc(aim.centre, aim.radius);
    weights += aim.weight;
  }
  return (1.0 - kAimed) * disc(whole.centre, static_cast<double>(whole.radius)) +
         kAimed * aimed / weights;
}

void expect_its_density(const DistantStart& start, const Geometry::Ball& whole) {
  constexpr int kCells = 40, kParts = 20;
  constexpr double kHalf = 7.0, kCell = 2.0 * kHalf / kCells;
  for (const Vec3 towards : {Vec3{0, 0, 1}, normalized({-1, 2, 0.5f})}) {
    const Frame frame(towards);
    std::vector<double> observed(kCells * kCells), expected(kCells * kCells);
    for (std::uint32_t i = 0; i < kDraws; ++i) {
      const auto drawn = start.sample(towards, kScene, kAimed, numbers(i));
      EXPECT_NEAR(dot(drawn.origin - kScene.centre, towards), kScene.radius, 1e-5f);
      const auto [x, y] = across(frame, drawn.origin);
      const double claimed = static_cast<double>(drawn.pdf), truth = density(frame, x, y, whole);
      // But for those at a rim; a radius is half of a box of floats.
      if (i < 1000) {
        EXPECT_NEAR(claimed, truth, 1e-4 * truth);
      }
      const auto column = static_cast<int>((x + kHalf) / kCell),
                 row = static_cast<int>((y + kHalf) / kCell);
      ++observed.at(static_cast<std::size_t>(row * kCells + column));
    }
    for (int i = 0; i < kCells * kCells * kParts * kParts; ++i) {
      const int column = i % (kCells * kParts), row = i / (kCells * kParts);
      const double step = kCell / kParts;
      expected[static_cast<std::size_t>(row / kParts * kCells + column / kParts)] +=
          kDraws * step * step *
          density(frame, (column + 0.5) * step - kHalf, (row + 0.5) * step - kHalf, whole);
    }
    test::expect_same_counts(observed, expected);
  }
}

TEST(DistantStart, DrawsPlacesByTheirDensity) {
  expect_its_density(DistantStart(elements(kAims)), kScene);
}

TEST(DistantStart, ReachesOnePartOfTheSceneAlone) {
  expect_its_density(DistantStart(elements(kAims), kReached), kReached);
}

// A sample at the rim of a small ball far from the scene's middle is never taken for a draw of the
// scene's disc alone, which would weigh ten thousand times as much.
TEST(DistantStart, NoDrawFallsOffTheRimOfASmallBall) {
  const std::vector<Aim> one{{{4, -1, 2}, 1e-4f, 1.0f}};
  const DistantStart start(elements(one));
  const float least = kAimed / (kPi * 1e-8f);
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    Uniform4 u = numbers(i);
    u[2] *= kAimed;
    EXPECT_GT(start.sample(normalized({1, 1, 1}), kScene, kAimed, u).pdf, 0.9f * least);
  }
}

TEST(DistantStart, ManyAimsAreOneBall) {
  std::vector<Aim> many;
  for (int i = 0; i < 65; ++i)
    many.push_back({{1.0f + 0.01f * static_cast<float>(i), 2, 3}, 0.1f, 1.0f});
  const DistantStart start(elements(many));
  Uniform4 aimed = numbers(0);
  aimed[2] = 0.0f;
  const float half = 0.5f * length(Vec3{0.84f, 0.2f, 0.2f});
  EXPECT_NEAR(start.sample({0, 0, 1}, kScene, kAimed, aimed).pdf,
              (1.0f - kAimed) / (kPi * 25.0f) + kAimed / (kPi * half * half), 1e-3f);
}

TEST(DistantStart, WithoutAimsAllOfTheDiscIsAlike) {
  const DistantStart start(elements({}));
  for (std::uint32_t i = 0; i < 100; ++i) {
    EXPECT_FLOAT_EQ(start.sample({0, 1, 0}, kScene, kAimed, numbers(i)).pdf, 1.0f / (kPi * 25.0f));
    EXPECT_FLOAT_EQ(
        DistantStart(elements({}), kReached).sample({0, 1, 0}, kScene, kAimed, numbers(i)).pdf,
        1.0f / (kPi * 4.0f));
  }
}

}  // namespace
}  // namespace nocturne

// Directions towards triangles, parallelograms and spheres: draws against densities, and
// irradiances against answers on paper.
#include <limits>

#include "luminaires/area_light_sampler.h"
#include "support/chi_square.h"
#include "support/irradiance.h"

namespace nocturne {
namespace {

using Corners = std::array<Vec3, 3>;
constexpr LightSamplingContext kUp{{0, 0, 0}, {0, 0, 1}};

LightSamplingContext anywhere(Vec3 position) { return {position, {0, 0, 1}, true}; }

void expect_consistent(const AreaLightSampler& directions, const LightSamplingContext& from,
                       int parts = 48) {
  test::expect_samples_match_pdf(
      [&](const Uniform4& u) -> std::optional<Vec3> {
        const auto drawn = directions.sample(from, u[1], u[2], u[3]);
        if (!drawn) return std::nullopt;
        return drawn->direction;
      },
      [&](Vec3 w) { return directions.pdf(from, w); }, parts);
}

// The density's steps at the rim of something small need a finer grid.
constexpr int kFine = 200;

Emission emission(float radiance = 1.0f, bool two_sided = true) { return {radiance, two_sided}; }

Elements one_triangle(Vec3 shift = {}) {
  Elements e;
  const Corners c{Vec3{1.0f, -1.0f, 1.0f} + shift, Vec3{1.5f, 2.0f, 0.5f} + shift,
                  Vec3{-1.0f, 0.5f, 2.0f} + shift};
  e.add_triangle({&c, 1}, emission());
  return e;
}

void add_rectangle(Elements& e, float z, Emission how = emission()) {
  const Corners c{Vec3{-1, -1, z}, Vec3{-1, 1.5f, z}, Vec3{1, -1, z}};  // emits down
  e.add_parallelogram({&c, 1}, how);
}

void add_sphere(Elements& e, Sphere s, Emission how = emission()) { e.add_sphere({&s, 1}, how); }

// A grid of triangles on a bowl: enough of them for the tree.
void add_bowl(Elements& e) {
  constexpr int kSide = 8;
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int j = 0; j <= kSide; ++j) {
    for (int i = 0; i <= kSide; ++i) {
      const float x = 2.0f * static_cast<float>(i) / kSide - 1.0f,
                  y = 2.0f * static_cast<float>(j) / kSide - 1.0f;
      vertices.push_back({x, y, 1.0f + 0.4f * (x * x + y * y)});
    }
  }
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i, b = a + kSide + 1;
      triangles.push_back({a, a + 1, b});
      triangles.push_back({a + 1, b + 1, b});
    }
  }
  const std::span<const Vec3> at_rest(vertices);
  e.add_mesh({&at_rest, 1}, triangles, emission());
}

TEST(Elements, TriangleFromAfarAndFromClose) {
  expect_consistent(AreaLightSampler(one_triangle({4, 0, 5})), anywhere({0.1f, 0.2f, -1.0f}),
                    kFine);
  expect_consistent(AreaLightSampler(one_triangle()), anywhere({0.1f, 0.2f, -0.3f}));
  expect_consistent(AreaLightSampler(one_triangle()), anywhere({0.4f, 0.4f, 0.9f}));
}

TEST(Elements, RectangleFromAfarAndFromClose) {
  for (const float z : {0.02f, 0.3f, 1.0f}) {
    Elements e;
    add_rectangle(e, z);
    ASSERT_EQ(e.size(), 1u);
    expect_consistent(AreaLightSampler(e), anywhere({0.3f, 0.2f, 0.0f}));
  }
  Elements far;
  add_rectangle(far, 7.0f);
  expect_consistent(AreaLightSampler(far), anywhere({6.0f, 1.0f, 0.0f}), kFine);
}

TEST(Elements, SphereFromOutsideAndInside) {
  Elements outside, inside;
  add_sphere(outside, {1.0, 1.0, 1.0, 0.9});
  add_sphere(inside, {0.1, 0.0, 0.0, 2.0});
  expect_consistent(AreaLightSampler(outside), anywhere({0, 0, 0}));
  expect_consistent(AreaLightSampler(inside), anywhere({0, 0, 0}));
}

TEST(Elements, OneBehindAnotherAddUp) {
  Elements e;
  add_rectangle(e, 1.0f);
  add_rectangle(e, 1.7f, emission(3.0f));
  add_sphere(e, {0.0, 0.0, 4.0, 1.0});
  add_sphere(e, {0.0, -2.0, 0.0, 0.8}, emission(2.0f));
  const AreaLightSampler directions(e);
  expect_consistent(directions, anywhere({0.3f, 0.2f, 0.1f}));
  expect_consistent(directions, {{0.3f, 0.2f, 0.1f}, normalized({1, -2, 1}), false});
}

TEST(Elements, ManyUseTheTree) {
  Elements e;
  add_bowl(e);
  add_rectangle(e, 2.5f);
  const AreaLightSampler directions(e);
  expect_consistent(directions, anywhere({0.1f, 0.1f, 0.0f}));
  expect_consistent(directions, {{0.1f, 0.1f, 0.0f}, normalized({1, 0, 0.2f}), false});
  expect_consistent(AreaLightSampler(e, LightTree::Choice::kWeight),
                    {{0.1f, 0.1f, 0.0f}, normalized({1, 0, 0.2f}), false});
}

// Two triangles of a mesh that are a parallelogram are one element.
TEST(Elements, MeshPairsTriangles) {
  const std::vector<Vec3> v{{-1, -1, 1}, {1, -1, 1}, {1, 1.5f, 1}, {-1, 1.5f, 1}, {5, 5, 5}};
  const std::vector<std::array<std::uint32_t, 3>> t{{0, 1, 2}, {0, 2, 3}, {0, 1, 4}};
  const std::span<const Vec3> at_rest(v);
  Elements e;
  e.add_mesh({&at_rest, 1}, t, emission());
  EXPECT_EQ(e.size(), 2u);
  EXPECT_NEAR(e.bounds(0).weight, 5.0, 1e-5);
}

// At every time, moving elements equal elements at rest in the same place.
TEST(Elements, MovingIsRestAtEveryTime) {
  const std::vector<Corners> triangle{{Vec3{1, -1, 1}, Vec3{1.5f, 2, 0.5f}, Vec3{-1, 0.5f, 2}},
                                      {Vec3{1, 1, 1}, Vec3{2.5f, 2, 1.5f}, Vec3{-1, 2.5f, 2}},
                                      {Vec3{0, 1, 1}, Vec3{2.5f, 3, 2.5f}, Vec3{-1, 3.5f, 2}}};
  const std::vector<Sphere> sphere{{1, 1, -2, 0.5}, {2, 1, -2, 0.5}};
  Elements moving;
  moving.add_triangle(triangle, emission());
  moving.add_sphere(sphere, emission());
  const AreaLightSampler directions(moving);
  LightSamplingContext from = anywhere({0.1f, 0.2f, -0.3f});
  from.time = 0.75f;
  expect_consistent(directions, from);

  Elements rest;
  Corners then;
  for (std::size_t i = 0; i < 3; ++i) then[i] = 0.5f * (triangle[1][i] + triangle[2][i]);
  rest.add_triangle({&then, 1}, emission());
  add_sphere(rest, {1.75, 1, -2, 0.5});
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const auto u = test::numbers(i);
    const Vec3 w = UniformSphere::sample(u[0], u[1]);
    ASSERT_NEAR(moving.pdf(0, from, w), rest.pdf(0, from, w), 1e-4f * rest.pdf(0, from, w));
    ASSERT_NEAR(moving.pdf(1, from, w), rest.pdf(1, from, w), 1e-4f * rest.pdf(1, from, w));
  }
}

TEST(Elements, NothingToPointAt) {
  Elements e;
  add_rectangle(e, 1.0f, emission(0.0f));
  const Corners line{Vec3{0, 0, 1}, Vec3{1, 1, 1}, Vec3{2, 2, 1}}, point{};
  e.add_triangle({&line, 1}, emission());
  e.add_parallelogram({&point, 1}, emission());
  add_sphere(e, {0, 0, 1, 0.0});
  const AreaLightSampler directions(e);
  EXPECT_TRUE(directions.empty());
  EXPECT_FALSE(directions.sample(kUp, 0.5f, 0.5f, 0.5f));
  EXPECT_EQ(directions.pdf(kUp, {0, 0, 1}), 0.0f);
}

TEST(Elements, RefusesNonsense) {
  Elements e;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Corners good{Vec3{0, 0, 1}, Vec3{1, 0, 1}, Vec3{0, 1, 1}},
      bad{Vec3{0, nan, 1}, Vec3{1, 0, 1}, Vec3{0, 1, 1}};
  EXPECT_THROW(e.add_triangle({&bad, 1}, emission()), std::invalid_argument);
  EXPECT_THROW(e.add_triangle({}, emission()), std::invalid_argument);
  EXPECT_THROW(e.add_triangle({&good, 1}, emission(-1.0f)), std::invalid_argument);
  EXPECT_THROW(e.add_triangle({&good, 1}, emission(nan)), std::invalid_argument);
  EXPECT_THROW(e.add_triangle({&good, 1}, {1.0f, false, -2.0f}), std::invalid_argument);
  EXPECT_THROW(add_sphere(e, {0, 0, 0, -1.0}), std::invalid_argument);
  EXPECT_EQ(e.size(), 0u);
}

// Positions on, in, next to and behind everything: never a NaN, and no density below the horizon.
TEST(Elements, OddPositions) {
  Elements e;
  add_rectangle(e, 1.0f, emission(1.0f, false));
  add_sphere(e, {0, 0, 3, 1.0}, emission(1.0f, false));
  add_bowl(e);
  const Corners sliver{Vec3{0, 0, 5}, Vec3{1000, 0, 5}, Vec3{1000, 1e-4f, 5}};
  e.add_triangle({&sliver, 1}, emission());
  const AreaLightSampler directions(e);
  for (const Vec3 p : {Vec3{-1, -1, 1}, Vec3{0, 0, 1}, Vec3{0, 0, 1.0000001f}, Vec3{3, 0, 1},
                       Vec3{0, 0, 3}, Vec3{0, 0, 2}, Vec3{1, 0, 3}, Vec3{0, 0, 5}, Vec3{500, 0, 5},
                       Vec3{1e6f, 1e6f, -1e6f}, Vec3{-1, -1, 1.8f}}) {
    for (const Vec3 n : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}}) {
      const LightSamplingContext from{p, n};
      for (std::uint32_t i = 0; i < 500; ++i) {
        const auto u = test::numbers(i);
        const auto w = directions.sample(from, u[0], i % 5 == 0 ? 0.0f : u[1], u[2]);
        const Vec3 d = w ? w->direction : UniformSphere::sample(u[1], u[2]);
        if (w) {
          ASSERT_NEAR(length(d), 1.0f, 1e-5f);
          ASSERT_GT(dot(d, n), 0.0f);
        }
        const float pdf = directions.pdf(from, d);
        ASSERT_TRUE(pdf >= 0.0f && std::isfinite(pdf));
        ASSERT_EQ(directions.pdf(from, -n), 0.0f);
      }
    }
  }
}

// The tree finds on a half-line what asking each element finds.
TEST(LightTree, FindsAllOnAHalfLine) {
  Elements e;
  add_bowl(e);
  for (int i = 0; i < 20; ++i) add_sphere(e, {0.2 * i - 2, 0.3, 2.0 + 0.2 * i, 0.3});
  const AreaLightSampler directions(e);
  for (const bool flat : {false, true}) {
    for (std::uint32_t i = 0; i < 3000; ++i) {
      const auto u = test::numbers(i);
      const LightSamplingContext from = anywhere({u[0] - 0.5f, 0.0f, u[1]});
      Vec3 w = UniformSphere::sample(u[2], u[3]);
      if (flat) w = normalized({0.0f, w.y, w.z});  // zeros among its components
      double sum = 0.0;
      for (std::uint32_t k = 0; k < e.size(); ++k) {
        sum += static_cast<double>(e.pdf(k, from, w)) * directions.tree().probability(from, k);
      }
      ASSERT_NEAR(directions.pdf(from, w), sum, 1e-5 * sum + 1e-12);
    }
  }
}

// A disc as a fan of triangles, and a sphere, both on the receiver's axis: E = pi L r^2 / (r^2 +
// d^2), and pi L (R / d)^2 cos of the receiver's tilt (Howell, "A Catalog of Radiation Heat
// Transfer Configuration Factors"; the fan's own area for its circle).
TEST(Irradiance, DiscAndSphere) {
  struct Case {
    double radius, distance;
  };
  for (const Case c : {Case{1.0, 2.0}, Case{0.01, 3.0}, Case{0.001, 10.0}, Case{1e-6, 1.0}}) {
    constexpr int kBlades = 256;
    Elements disc, ball;
    const auto corner = [&](int i) {
      const double phi = 2.0 * std::numbers::pi * i / kBlades;
      return Vec3{static_cast<float>(c.radius * std::cos(phi)),
                  static_cast<float>(c.radius * std::sin(phi)), static_cast<float>(c.distance)};
    };
    for (int i = 0; i < kBlades; ++i) {
      const Corners t{Vec3{0, 0, static_cast<float>(c.distance)}, corner(i + 1), corner(i)};
      disc.add_triangle({&t, 1}, emission(1.0f, false));
    }
    const double blade = 2.0 * std::numbers::pi / kBlades;
    // The polygon's form factor is not the disc's, but for an answer to 1e-4 its area is enough.
    const double share = std::sin(blade) / blade;
    const double r2 = c.radius * c.radius, d2 = c.distance * c.distance;
    const auto one = [](Vec3) { return 1.0; };
    // Directions of float can't tell where on a lamp below 1e-4 of its distance they point: the
    // density of the fan is that of its rim for some.
    if (c.radius > 1e-5) {
      test::expect_mean(test::irradiance(AreaLightSampler(disc), kUp, one),
                        std::numbers::pi * r2 / (r2 + d2) * share, 2e-3 * 1e-4 / c.radius + 1e-4);
    }
    add_sphere(ball, {0, 0, c.distance, c.radius}, emission(1.0f, false));
    const AreaLightSampler directions(ball);
    const double sin2 = r2 / d2;
    const auto on_ball = [&](Vec3 w) {  // what a ray would meet
      const double across2 = static_cast<double>(w.x) * w.x + static_cast<double>(w.y) * w.y;
      return across2 <= sin2 * (across2 + static_cast<double>(w.z) * w.z) ? 1.0 : 0.0;
    };
    test::expect_mean(test::irradiance(directions, kUp, on_ball), std::numbers::pi * sin2, 1e-4);
    if (c.radius < 0.5) {  // wholly above the tilted horizon
      const LightSamplingContext tilted{{0, 0, 0}, {std::sqrt(0.75f), 0, 0.5f}};
      test::expect_mean(test::irradiance(directions, tilted, on_ball),
                        0.5 * std::numbers::pi * sin2, 1e-4);
    }
  }
}

// Below the middle of a lamp of 1 m x 1 m: form factor of a corner rectangle, four times (Howell
// B-4). The spread of a draw is what solid angle is for.
TEST(Irradiance, SquareLampFromCloseBy) {
  for (const double d : {0.01, 0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0}) {
    const auto z = static_cast<float>(d);
    const Corners c{Vec3{-0.5f, -0.5f, z}, Vec3{-0.5f, 0.5f, z}, Vec3{0.5f, -0.5f, z}};
    Elements e;
    e.add_parallelogram({&c, 1}, emission(1.0f, false));
    const double x = 0.5 / d, root = std::sqrt(1.0 + x * x);
    const double truth = 4.0 * x / root * std::atan(x / root);  // pi L times the form factor
    const auto estimate = test::irradiance(AreaLightSampler(e), kUp, [](Vec3) { return 1.0; });
    test::expect_mean(estimate, truth, 1e-4);
    const auto by_area = test::estimate(100'000, [&](const Uniform4& u) {
      const double px = u[0] - 0.5, py = u[1] - 0.5, r2 = px * px + py * py + d * d;
      return d * d / (r2 * r2);
    });
    test::expect_mean(by_area, truth);
    std::printf("distance %.2f m: spread by area %.3f, as drawn %.3f\n", d,
                by_area.relative_spread(), estimate.relative_spread());
    EXPECT_LT(estimate.relative_spread(), 1.0);
  }
}

}  // namespace
}  // namespace nocturne

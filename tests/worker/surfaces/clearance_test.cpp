// A ray that leaves a surface does not meet it again, whatever the scale and wherever it stands.
#include <gtest/gtest.h>

#include <optional>

#include "surfaces/geometry.h"
#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

struct Case {
  const char* name;
  Shape shape;
  std::optional<Transform> transform;
  // About where and how large it is in the scene.
  Vec3 centre;
  float size;
};

Geometry geometry_of(const Case& c) {
  if (!c.transform) return Geometry({c.shape});
  return Geometry({c.shape}, {1}, {{1, {*c.transform}}});
}

// Rays from random points around the shape to random points near it, and from where they hit in a
// random direction. A flat shape is never met again from where it was left; a sphere not from
// outside.
void expect_no_second_hit(const Case& c, std::uint32_t rays) {
  const Geometry geometry = geometry_of(c);
  std::uint32_t hits = 0, again = 0;
  for (std::uint32_t i = 0; i < rays; ++i) {
    const Vec3 from = c.centre + 3.0f * c.size * test::any_direction(i, 1);
    const Vec3 to = c.centre + 0.5f * c.size * test::any_point(i, 2);
    const auto hit = geometry.intersect({from, normalized(to - from)}, 0.0f);
    if (!hit) continue;
    ++hits;
    Vec3 direction = test::any_direction(i, 3);
    if (std::holds_alternative<Sphere>(c.shape) && dot(direction, hit->normal) < 0.0f) {
      direction = -direction;
    }
    again += geometry.intersect({leave_surface(*hit, direction), direction}, 0.0f).has_value();
  }
  EXPECT_GT(hits, rays / 10) << c.name;
  EXPECT_EQ(again, 0u) << c.name << ": of " << hits << " hits";
}

// A square that lies askew: no coordinate is special.
TriangleMesh askew(float size, Vec3 centre) {
  const Vec3 u = size * Vec3{0.61f, 0.52f, -0.33f}, v = size * Vec3{-0.21f, 0.55f, 0.71f};
  return quad_mesh(centre - 0.5f * (u + v), u, v);
}

constexpr std::uint32_t kRays = 100'000;
const Double3 kAxis{1.0, 2.0, -0.7};

TEST(Clearance, TrianglesOfAllSizesAndPlaces) {
  for (const float size : {1e-6f, 1.0f, 1e6f}) {
    expect_no_second_hit({"at the origin", askew(size, {}), {}, {}, size}, kRays);
    // Far away a shape must still be larger than the spacing of coordinates there.
    for (const float offset : {1e3f, 1e5f}) {
      if (size < 1.0f) continue;
      const Vec3 centre = offset * Vec3{0.8f, -1.0f, 0.3f};
      expect_no_second_hit({"far", askew(size, centre), {}, centre, size}, kRays);
    }
  }
}

TEST(Clearance, ALargeTriangleNearTheOrigin) {
  // The point's coordinates are small, those that it is computed from large.
  const float size = 1e4f;
  Case c{"large", askew(size, {}), {}, {}, 1e-2f};
  expect_no_second_hit(c, kRays);
}

TEST(Clearance, InstancesOfAllScales) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const double offset : {0.0, 1e3, 1e5}) {
      const Double3 translation{0.8 * offset, -offset, 0.3 * offset};
      // About a metre in the scene; or as large as the scale says.
      for (const double group_size : {1.0, 1.0 / scale}) {
        const double size = group_size * scale;
        if (size < 1e-5 * offset) continue;
        const Transform t = test::transform({scale, scale, scale}, kAxis, 1.1, translation);
        expect_no_second_hit({"uniform", askew(static_cast<float>(group_size), {}), t,
                              translation.rounded(), static_cast<float>(size)},
                             kRays / 2);
      }
    }
  }
}

TEST(Clearance, GroupsFarFromTheirOrigin) {
  for (const float offset : {1e3f, 1e5f}) {
    const Vec3 centre = offset * Vec3{0.8f, -1.0f, 0.3f};
    const Transform t = test::transform({0.5, 0.5, 0.5}, kAxis, 1.1, {});
    // Moved back to the origin, so that only the coordinates in the group are large.
    Transform back = t;
    const Double3 there = test::apply(t, centre);
    back[3] = -there.x;
    back[7] = -there.y;
    back[11] = -there.z;
    expect_no_second_hit({"far in its group", askew(1.0f, centre), back, Vec3{}, 1.0f}, kRays);
  }
}

TEST(Clearance, InstancesThatStretchAndMirror) {
  for (const Double3 scale : {Double3{1e-3, 1.0, 1e3},
                              {1e3, 1e-3, 1.0},
                              {-1.0, 1.0, 1.0},
                              {1e-6, 1e-6, 1.0},
                              {1e6, 1.0, 1e-6}}) {
    for (const double offset : {0.0, 1e3}) {
      const Double3 translation{0.8 * offset, -offset, 0.3 * offset};
      const auto size = static_cast<float>(
          std::max({std::fabs(scale.x), std::fabs(scale.y), std::fabs(scale.z)}));
      const Transform t = test::transform(scale, kAxis, 2.3, translation);
      const Geometry geometry({askew(1.0f, {})}, {1}, {{1, {t}}});
      // Rays at points of the square, from any side.
      std::uint32_t hits = 0, again = 0;
      for (std::uint32_t i = 0; i < kRays; ++i) {
        const auto u = test::any_numbers(i, 5);
        const Double3 local = Double3(Vec3{0.61f, 0.52f, -0.33f});
        const Double3 other = Double3(Vec3{-0.21f, 0.55f, 0.71f});
        const Vec3 to =
            test::apply(t, (0.9 * (u[0] - 0.5)) * local + (0.9 * (u[1] - 0.5)) * other).rounded();
        const Vec3 towards = test::any_direction(i, 6);
        const auto hit = geometry.intersect({to - size * towards, towards}, 0.0f);
        if (!hit) continue;
        ++hits;
        const Vec3 direction = test::any_direction(i, 7);
        again += geometry.intersect({leave_surface(*hit, direction), direction}, 0.0f).has_value();
      }
      // A needle thinner than the spacing of coordinates is hit by few.
      EXPECT_GT(hits, kRays / 200) << scale.x << " " << scale.y << " " << scale.z;
      EXPECT_EQ(again, 0u) << scale.x << " " << scale.y << " " << scale.z << " at " << offset
                           << ", of " << hits;
    }
  }
}

TEST(Clearance, Spheres) {
  for (const double radius : {1e-6, 1.0, 1e6}) {
    const auto size = static_cast<float>(radius);
    expect_no_second_hit({"sphere", Sphere{0, 0, 0, radius}, {}, {}, size}, kRays / 2);
    const Transform t =
        test::transform({radius, 2.0 * radius, 0.5 * radius}, kAxis, 0.4, {1e3, 0, 0});
    if (radius >= 1.0) {
      expect_no_second_hit({"ellipsoid", Sphere{0, 0, 0, 1}, t, {1e3, 0, 0}, size}, kRays / 2);
      expect_no_second_hit({"far", Sphere{1e5, 0, 0, radius}, {}, {1e5, 0, 0}, size}, kRays / 2);
    }
  }
  // A point near the origin on a large sphere.
  const Geometry ground({Sphere{0, 0, -6.4e6, 6.4e6}});
  for (std::uint32_t i = 0; i < kRays / 2; ++i) {
    const auto hit =
        ground.intersect({1e-2f * test::any_point(i) + Vec3{0, 0, 1}, {0, 0, -1}}, 0.0f);
    ASSERT_TRUE(hit);
    Vec3 direction = test::any_direction(i);
    if (dot(direction, hit->normal) < 0.0f) direction = -direction;
    ASSERT_FALSE(ground.intersect({leave_surface(*hit, direction), direction}, 0.0f));
  }
}

}  // namespace
}  // namespace nocturne

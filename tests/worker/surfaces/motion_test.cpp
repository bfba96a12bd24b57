// What moves is, at any time, where a scene at rest has it.
#include <gtest/gtest.h>

#include "surfaces/geometry.h"
#include "surfaces/sphere_intersection.h"
#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

constexpr std::uint32_t kTimes = 40, kRays = 100;

Ray ray_at(std::uint32_t i) {
  const Vec3 from = 5.0f * test::any_direction(i, 1);
  return {from, normalized(1.2f * test::any_point(i, 2) - from)};
}

void expect_same(const std::optional<Hit>& a, const std::optional<Hit>& b, float tolerance,
                 std::uint32_t& differences) {
  // At an edge one may hit and the other miss.
  if (a.has_value() != b.has_value() || (a && a->primitive != b->primitive)) {
    ++differences;
    return;
  }
  if (!a) return;
  // Along a ray that grazes, the same rounding moves the point further.
  EXPECT_LT(max_abs(a->position - b->position), tolerance);
  EXPECT_LT(max_abs(a->normal - b->normal), 10 * tolerance);
}

TriangleMesh wobbling(const TriangleMesh& rest, std::uint32_t steps) {
  TriangleMesh mesh = rest;
  mesh.time_steps = steps;
  for (std::uint32_t step = 1; step < steps; ++step) {
    for (std::size_t i = 0; i < rest.vertices.size(); ++i) {
      mesh.vertices.push_back(rest.vertices[i] + 0.3f * test::any_point(step, 77) +
                              0.02f * test::any_point(static_cast<std::uint32_t>(i), step));
      mesh.normals.push_back(normalized(
          rest.normals[i] + 0.2f * test::any_point(static_cast<std::uint32_t>(i), step)));
    }
  }
  return mesh;
}

TriangleMesh frozen(const TriangleMesh& moving, double time) {
  TriangleMesh mesh = moving;
  const std::size_t count = moving.vertex_count();
  const double position = time * (moving.time_steps - 1);
  const auto step =
      std::min<std::size_t>(static_cast<std::size_t>(position), moving.time_steps - 2);
  const double f = position - static_cast<double>(step);
  mesh.time_steps = 1;
  mesh.vertices.resize(count);
  mesh.normals.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto between = [&](const std::vector<Vec3>& values) {
      const Double3 from = values[step * count + i], to = values[(step + 1) * count + i];
      return ((1.0 - f) * from + f * to).rounded();
    };
    mesh.vertices[i] = between(moving.vertices);
    mesh.normals[i] = between(moving.normals);
  }
  return mesh;
}

TEST(Motion, MeshesAreWhereTheirVerticesAre) {
  const TriangleMesh rest = test::lumpy_ball(12);
  for (const std::uint32_t steps : {2u, 3u, 7u, 129u}) {
    const TriangleMesh mesh = wobbling(rest, steps);
    const Geometry moving({mesh});
    std::uint32_t differences = 0, hits = 0;
    for (std::uint32_t k = 0; k <= kTimes; ++k) {
      const float time = static_cast<float>(k) / kTimes;
      const Geometry at_rest({frozen(mesh, time)});
      for (std::uint32_t i = 0; i < kRays; ++i) {
        const Ray ray = ray_at(kRays * k + i);
        const auto a = moving.intersect(ray, time), b = at_rest.intersect(ray, 0.0f);
        expect_same(a, b, 1e-4f, differences);
        if (!a || !b || a->primitive != b->primitive) continue;
        ++hits;
        const SurfaceDetail da = moving.detail(*a, time), db = at_rest.detail(*b, 0.0f);
        EXPECT_LT(max_abs(da.shading_normal - db.shading_normal), 1e-3f);
        EXPECT_NEAR(da.u, db.u, 1e-4f);
        EXPECT_LT(max_abs(da.dp_dv - db.dp_dv), 1e-3f);
      }
    }
    EXPECT_GT(hits, kRays * kTimes / 2);
    EXPECT_LT(differences, kRays * kTimes / 200);
  }
}

TEST(Motion, SpheresAreWhereTheirCentreIs) {
  const Sphere sphere{-1, 0.2, 0, 0.7, {{0, 0, 0.5}, {1.0, -0.5, 0}, {0.3, 0.3, 0.3}}};
  const Geometry geometry({sphere});
  const std::array<Double3, 4> centres{
      {{-1, 0.2, 0}, {0, 0, 0.5}, {1.0, -0.5, 0}, {0.3, 0.3, 0.3}}};
  std::uint32_t hits = 0;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const float time = test::any_numbers(i, 9)[0];
    const Ray ray = ray_at(i);
    const double position = 3.0 * static_cast<double>(time);
    const auto step = static_cast<std::size_t>(position);
    const double f = position - static_cast<double>(step);
    const Double3 c = (1.0 - f) * centres[step] + f * centres[step + 1];
    // |o + t d - c| = r, by the quadratic formula.
    const Double3 o = Double3(ray.origin) - c, d = ray.direction;
    const double b = dot(o, d) / dot(d, d);
    const double root = b * b - (dot(o, o) - 0.49) / dot(d, d);
    const auto hit = geometry.intersect(ray, time);
    if (std::fabs(root) < 1e-5) continue;  // grazes
    ASSERT_EQ(hit.has_value(), root > 0.0);
    if (!hit) continue;
    ++hits;
    const Double3 p = Double3(ray.origin) + (-b - std::sqrt(root)) * d;
    const double graze = 1.0 / std::sqrt(root);
    EXPECT_LT(length(Double3(hit->position) - p), 2e-6 * std::max(1.0, graze));
    EXPECT_LT(length(Double3(hit->normal) - (1.0 / 0.7) * (p - c)), 4e-6 * std::max(1.0, graze));
  }
  EXPECT_GT(hits, 4'000u);
}

TEST(Motion, InstancesAreWhereTheirMatrixIs) {
  const TriangleMesh mesh = test::lumpy_ball(12);
  const Transform from = test::transform({1, 0.6, 0.9}, {1, 0, 1}, 0.2, {-0.5, 0, 0});
  const Transform middle = test::transform({0.8, 0.7, 1.1}, {1, 0.4, 1}, 1.2, {0.2, 0.5, 0});
  const Transform to = test::transform({1.1, 0.6, 0.7}, {0, 0.4, 1}, 1.9, {0.5, 0, 0.3});
  const Geometry moving({mesh, Sphere{0, 0, 0, 0.9}}, {3, 3}, {{3, {from, middle, to}}});
  std::uint32_t differences = 0, hits = 0;
  for (std::uint32_t k = 0; k <= kTimes; ++k) {
    const float time = static_cast<float>(k) / kTimes;
    Transform t;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double s = 2.0 * static_cast<double>(time);
      t[i] =
          s < 1.0 ? (1.0 - s) * from[i] + s * middle[i] : (2.0 - s) * middle[i] + (s - 1.0) * to[i];
    }
    const Geometry at_rest({test::moved(mesh, t)});
    const Geometry both_at_rest({mesh, Sphere{0, 0, 0, 0.9}}, {1, 1}, {{1, {t}}});
    for (std::uint32_t i = 0; i < kRays; ++i) {
      const Ray ray = ray_at(kRays * k + i);
      const auto hit = moving.intersect(ray, time);
      expect_same(hit, both_at_rest.intersect(ray, 0.5f), 1e-5f, differences);
      if (hit && hit->surface == 0) {
        ++hits;
        expect_same(hit, at_rest.intersect(ray, 0.0f), 1e-4f, differences);
      }
    }
  }
  EXPECT_GT(hits, kRays * kTimes / 4);
  EXPECT_LT(differences, kRays * kTimes / 100);
}

// A mesh that moves in an instance that moves: position is the product of both.
TEST(Motion, MotionWithinMotion) {
  const TriangleMesh mesh = wobbling(test::lumpy_ball(8), 3);
  const Transform from = test::transform({1, 1, 1}, {1, 0, 1}, 0.0, {-0.5, 0, 0});
  const Transform to = test::transform({0.7, 1.2, 1}, {1, 0, 1}, 0.9, {0.5, 0, 0});
  const Geometry moving({mesh}, {1}, {{1, {from, to}}});
  std::uint32_t differences = 0, hits = 0;
  for (std::uint32_t k = 0; k <= kTimes; ++k) {
    const float time = static_cast<float>(k) / kTimes;
    Transform t;
    for (std::size_t i = 0; i < t.size(); ++i) {
      t[i] = (1.0 - static_cast<double>(time)) * from[i] + static_cast<double>(time) * to[i];
    }
    const Geometry at_rest({test::moved(frozen(mesh, time), t)});
    for (std::uint32_t i = 0; i < kRays; ++i) {
      const Ray ray = ray_at(kRays * k + i);
      const auto hit = moving.intersect(ray, time);
      hits += hit.has_value();
      expect_same(hit, at_rest.intersect(ray, 0.0f), 1e-4f, differences);
    }
  }
  EXPECT_GT(hits, kRays * kTimes / 2);
  EXPECT_LT(differences, kRays * kTimes / 100);
}

TEST(Motion, AnInstanceThatIsSqueezedFlatIsNotSeenThen) {
  Transform flat = test::transform({1, 1, 1}, {0, 0, 1}, 0.0, {});
  Transform opposite = flat;
  opposite[0] = -1;
  const Geometry geometry({test::box(0.5f, {})}, {1}, {{1, {flat, opposite}}});
  EXPECT_TRUE(geometry.intersect({{0.05f, 0.1f, 5}, {0, 0, -1}}, 0.25f));
  EXPECT_FALSE(geometry.intersect({{0.05f, 0.1f, 5}, {0, 0, -1}}, 0.5f));
}

}  // namespace
}  // namespace nocturne

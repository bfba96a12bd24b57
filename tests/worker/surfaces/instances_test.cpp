#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "surfaces/geometry.h"
#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

const Double3 kAxis{1.0, 2.0, -0.7};

const std::vector<std::pair<const char*, Transform>>& transforms() {
  static const std::vector<std::pair<const char*, Transform>> all = {
      {"rotated", test::transform({1, 1, 1}, kAxis, 1.0, {2, -1, 0.5})},
      {"large", test::transform({1e3, 1e3, 1e3}, kAxis, 2.0, {0, 100, 0})},
      {"small", test::transform({1e-3, 1e-3, 1e-3}, kAxis, 2.0, {0, 1e-3, 0})},
      {"mirrored", test::transform({-1, 1, 1}, kAxis, 0.3, {1, 1, 1})},
      {"stretched", test::transform({0.2, 1, 3}, kAxis, 0.3, {1, 1, 1})},
      {"stretched and mirrored", test::transform({0.2, -1, 3}, kAxis, 0.9, {0, 0, 0})},
  };
  return all;
}

// What Embree builds may take minutes.
TEST(Instances, BuildingEndsWhenAStopIsRequested) {
  std::stop_source stop;
  const auto build = [&] {
    Geometry({Sphere{1e6, 0, 0, 1}, test::lumpy_ball(200)}, {0, 4}, {{4, {transforms()[0].second}}},
             stop.get_token());
  };
  EXPECT_NO_THROW(build());
  stop.request_stop();
  EXPECT_THROW(build(), std::runtime_error);
}

// Surface, position, normal on the outer side and distance, for rays at known points of an
// instance. Expected values are computed forwards, from group to scene, in double precision.
TEST(Instances, MeshesAreWhereTheMatrixSays) {
  const TriangleMesh mesh = test::lumpy_ball(16);
  for (const auto& [name, t] : transforms()) {
    SCOPED_TRACE(name);
    const Geometry geometry({Sphere{1e6, 0, 0, 1}, mesh}, {0, 4}, {{4, {t}}});
    const double size = length(test::apply(t, {1, 1, 1}) - test::apply(t, {}));
    const double largest = size + max_abs(test::apply(t, {}));
    std::uint32_t checked = 0;
    for (std::uint32_t i = 0; i < 4'000; ++i) {
      const auto u = test::any_numbers(i, 1);
      const auto triangle =
          static_cast<std::uint32_t>(u[0] * static_cast<float>(mesh.triangles.size()));
      const auto& corners = mesh.triangles[triangle];
      const double s = 0.1 + 0.3 * u[1], r = 0.1 + 0.3 * u[2];
      const Double3 a = test::apply(t, mesh.vertices[corners[0]]),
                    b = test::apply(t, mesh.vertices[corners[1]]),
                    c = test::apply(t, mesh.vertices[corners[2]]);
      const Double3 p = a + s * (b - a) + r * (c - a);
      // Out: away from the middle, which the surface surrounds star-shaped.
      Double3 n = cross(b - a, c - a);
      if (!(length(n) > 0.0)) continue;  // at the poles
      n = (1.0 / length(n)) * n;
      if (dot(n, p - test::apply(t, {})) < 0.0) n = -1.0 * n;
      const double height = 1e-2 * length(b - a);
      const Vec3 origin = (p + height * n).rounded();
      const Vec3 direction = (-1.0 * n).rounded();
      const auto hit = geometry.intersect({origin, direction}, 0.0f);
      ASSERT_TRUE(hit);
      if (hit->primitive != triangle) continue;  // a neighbour stands in front
      ++checked;
      EXPECT_EQ(hit->surface, 1u);
      EXPECT_EQ(hit->instance, 0u);
      EXPECT_LT(length(Double3(hit->position) - p), 1e-6 * largest);
      EXPECT_LT(length(Double3(hit->normal) - n), 1e-6);
      EXPECT_NEAR(hit->distance, height, 1e-6 * largest);
      EXPECT_NEAR(hit->u, s, 1e-3);
      EXPECT_NEAR(hit->v, r, 1e-3);
    }
    EXPECT_GT(checked, 3'000u);
  }
}

// A sphere in an instance is an ellipsoid: M (c + r n), with normal M^-T n.
TEST(Instances, SpheresBecomeEllipsoids) {
  const Sphere sphere{0.3, -0.2, 0.1, 0.8};
  for (const auto& [name, t] : transforms()) {
    SCOPED_TRACE(name);
    const Geometry geometry({sphere}, {1}, {{1, {t}}});
    const double size = length(test::apply(t, {1, 1, 1}) - test::apply(t, {}));
    const double largest = size + max_abs(test::apply(t, {}));
    for (std::uint32_t i = 0; i < 2'000; ++i) {
      const Double3 n_local = test::any_direction(i, 3);
      const Double3 local = Double3{0.3, -0.2, 0.1} + 0.8 * n_local;
      const Double3 p = test::apply(t, local);
      // Normal from two tangents carried forwards.
      const Double3 some = std::fabs(n_local.x) < 0.7 ? Double3{1, 0, 0} : Double3{0, 1, 0};
      const Double3 tangent = cross(n_local, some), other = cross(n_local, tangent);
      const Double3 origin = test::apply(t, {});
      Double3 n = cross(test::apply(t, tangent) - origin, test::apply(t, other) - origin);
      n = (1.0 / length(n)) * n;
      if (dot(n, p - test::apply(t, {0.3, -0.2, 0.1})) < 0.0) n = -1.0 * n;
      const auto hit =
          geometry.intersect({(p + 0.1 * size * n).rounded(), (-1.0 * n).rounded()}, 0.0f);
      ASSERT_TRUE(hit);
      EXPECT_LT(length(Double3(hit->position) - p), 1e-6 * largest);
      EXPECT_LT(length(Double3(hit->normal) - n), 2e-5);  // curvature times the point's rounding
      // Texture coordinates are those of the sphere in its group.
      const SurfaceDetail detail = geometry.detail(*hit, 0.0f);
      double azimuth = std::atan2(n_local.y, n_local.x) / (2.0 * std::numbers::pi);
      if (azimuth < 0.0) azimuth += 1.0;
      const double off_axis = std::hypot(n_local.x, n_local.y);
      EXPECT_NEAR(std::remainder(detail.u - azimuth, 1.0), 0.0, 1e-5 / off_axis);
      EXPECT_NEAR(detail.v, 1.0 - std::acos(n_local.z) / std::numbers::pi, 1e-5);
    }
  }
}

TEST(Instances, TheNearestOfSceneAndInstancesWins) {
  const Transform left = test::transform({1, 1, 1}, {0, 0, 1}, 0.0, {-3, 0, 0});
  const Transform right = test::transform({1, 1, 1}, {0, 0, 1}, 0.0, {3, 0, 0});
  const Transform moving = test::transform({1, 1, 1}, {0, 0, 1}, 0.0, {6, 0, 0});
  const Geometry geometry({Sphere{0, 0, 0, 1}, test::box(1.0f, {}), Sphere{0, 0, 5, 1}}, {0, 2, 2},
                          {{2, {left}}, {2, {right}}, {2, {moving, moving}}});
  const auto from_left = geometry.intersect({{-10, 0.1f, 0.2f}, {1, 0, 0}}, 0.3f);
  ASSERT_TRUE(from_left);
  EXPECT_EQ(from_left->instance, 0u);
  EXPECT_EQ(from_left->surface, 1u);
  EXPECT_FLOAT_EQ(from_left->position.x, -4.0f);
  const auto from_right = geometry.intersect({{10, 0.1f, 0.2f}, {-1, 0, 0}}, 0.3f);
  ASSERT_TRUE(from_right);
  EXPECT_EQ(from_right->instance, 2u);
  EXPECT_FLOAT_EQ(from_right->position.x, 7.0f);
  const auto middle = geometry.intersect({{0.1f, 10, 0.2f}, {0, -1, 0}}, 0.3f);
  ASSERT_TRUE(middle);
  EXPECT_EQ(middle->instance, Hit::kNoInstance);
  EXPECT_EQ(middle->surface, 0u);
  const auto sphere = geometry.intersect({{3, 0, 10}, {0, 0, -1}}, 0.3f);
  ASSERT_TRUE(sphere);
  EXPECT_EQ(sphere->instance, 1u);
  EXPECT_EQ(sphere->surface, 2u);
  // A group shows only where an instance shows it.
  EXPECT_FALSE(geometry.intersect({{0, 0, 10}, {0, 0, -1}}, 0.3f)->surface != 0);
}

TEST(Instances, ClosedBoxesLoseNoRay) {
  for (const auto& [name, t] : transforms()) {
    SCOPED_TRACE(name);
    const Geometry geometry({test::box(1.0f, {})}, {1}, {{1, {t}}});
    Ray ray{test::apply(t, {}).rounded(), test::any_direction(0)};
    for (std::uint32_t i = 1; i < 20'000; ++i) {
      const auto hit = geometry.intersect(ray, 0.0f);
      ASSERT_TRUE(hit) << i;
      Vec3 direction = test::any_direction(i);
      if (dot(direction, hit->normal) > 0.0f) direction = -direction;  // stay inside
      ray = {leave_surface(*hit, direction), direction};
    }
  }
}

TEST(Instances, RefusesWhatCannotBeShown) {
  const Transform good = test::transform({1, 1, 1}, {0, 0, 1}, 0.0, {});
  const Transform flat = test::transform({1, 0, 1}, {0, 0, 1}, 0.0, {});
  Transform infinite = good;
  infinite[7] = std::numeric_limits<double>::infinity();
  const auto make = [](std::uint32_t group, std::vector<Transform> transforms) {
    Geometry({test::box(1.0f, {}), Sphere{0, 0, 0, 1}}, {0, 1}, {{group, std::move(transforms)}});
  };
  EXPECT_NO_THROW(make(1, {good}));
  EXPECT_NO_THROW(make(1, std::vector<Transform>(129, good)));
  EXPECT_THROW(make(1, std::vector<Transform>(130, good)), std::invalid_argument);
  EXPECT_THROW(make(1, {}), std::invalid_argument);
  EXPECT_THROW(make(1, {flat}), std::invalid_argument);
  EXPECT_THROW(make(1, {good, infinite}), std::invalid_argument);
  EXPECT_THROW(make(0, {good}), std::invalid_argument);
  EXPECT_THROW(make(2, {good}), std::invalid_argument);
}

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(Instances, AThousandCostLittleMemory) {
  TriangleMesh mesh = test::lumpy_ball(50);  // 10,000 triangles
  ASSERT_EQ(mesh.triangles.size(), 10'000u);
  std::vector<Instance> instances;
  for (std::uint32_t i = 0; i < 1'000; ++i) {
    instances.push_back(
        {1, {test::transform({1, 1, 1}, kAxis, 0.1 * i, 20.0 * Double3(test::any_point(i)))}});
  }
  const std::size_t before = resident_bytes();
  const Geometry geometry({std::move(mesh)}, {1}, std::move(instances));
  const std::size_t after = resident_bytes();
  EXPECT_TRUE(geometry.intersect({{50, 0, 0}, {-1, 0, 0}}, 0.0f));
  RecordProperty("bytes", std::to_string(after - before));
  EXPECT_LT(after - before, std::size_t{100'000'000});
}

}  // namespace
}  // namespace nocturne

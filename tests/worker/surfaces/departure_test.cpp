// Rays leave surfaces that lie close together without a step, and meet them in their order.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "surfaces/geometry.h"
#include "surfaces/test_shapes.h"
#include "surfaces/thin_shapes.h"

namespace nocturne {
namespace {

using test::any_direction;
using test::any_numbers;

// Two square faces across z; their normals point apart.
TriangleMesh plate(float half, float thickness, float z) {
  TriangleMesh mesh = quad_mesh({-half, -half, z + thickness}, {2 * half, 0, 0}, {0, 2 * half, 0});
  const TriangleMesh below = quad_mesh({-half, -half, z}, {0, 2 * half, 0}, {2 * half, 0, 0});
  for (const auto& t : below.triangles) mesh.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  mesh.vertices.insert(mesh.vertices.end(), below.vertices.begin(), below.vertices.end());
  return mesh;
}

struct Case {
  float half, thickness, z;
  double distance;
  bool instanced;
};

Geometry geometry_of(const Case& c) {
  std::vector<Shape> shapes{plate(c.half, c.thickness, c.z)};
  const float reach = 4.0f * kClearanceUnits * (std::fabs(c.z) + 4.0f * c.half);
  const Transform turned = test::transform({1, 1, 1}, {1.0, 2.0, -0.7}, 1.1, {10.0, -3.0, 4.0});
  Geometry geometry =
      c.instanced ? Geometry(std::move(shapes), {1}, {{1, {turned}}}) : Geometry(std::move(shapes));
  geometry.set_close({{.reach = reach, .body = true}});
  return geometry;
}

// Up to three quarters of the angle to the horizon of the plate.
Vec3 a_direction(std::uint32_t i, Vec3 normal, bool outwards) {
  for (std::uint32_t j = 0;; ++j) {
    const Vec3 w = any_direction(i, j + 10);
    const float cosine = dot(w, normal);
    if (std::fabs(cosine) > 0.1f) return (cosine > 0.0f) == outwards ? w : -w;
  }
}

void expect_order(const Case& c) {
  const Geometry geometry = geometry_of(c);
  int seen = 0, wrong_first = 0, stuck = 0, passed_over = 0, again = 0;
  for (std::uint32_t i = 0; i < 4'000; ++i) {
    const auto u = any_numbers(i);
    const Vec3 local{c.half * (1.8f * u[0] - 0.9f), c.half * (1.8f * u[1] - 0.9f),
                     c.z + 0.5f * c.thickness};
    Vec3 target = local, normal{0, 0, 1};
    if (c.instanced) {
      const Placement placement = geometry.instances()[0].placement(0.0f);
      target = placement.point_to_scene(local).rounded();
      normal = placement.normal_to_scene({0, 0, 1}).rounded();
    }
    const Vec3 towards = a_direction(i, normal, false);
    const Vec3 from = (Double3(target) - c.distance * Double3(towards)).rounded();
    const Ray ray{from, towards};
    const auto found = geometry.intersect(ray, 0.0f);
    if (!found) continue;  // beside it, as seen from afar
    std::array<NearCrossing, 8> near;
    const float reach = (geometry.close(0).reach + kClearanceUnits * found->distance) / 0.1f;
    const std::size_t count = geometry.crossings_near(ray, 0.0f, {}, *found, reach, near);
    if (count == 0) continue;
    ++seen;
    const Hit top = near[0].hit;
    // A ray may also enter a thick body through its open rim.
    const bool thin = c.thickness < 1e-3f * c.half;
    wrong_first += thin && !near[0].at.entering() ? 1 : 0;
    const auto next = [&](const Hit& hit, bool outwards) {
      const Vec3 direction = a_direction(i + (outwards ? 1u : 2u) * 10'000u, hit.normal, outwards);
      const DepartingRay leaves = geometry.depart(hit, direction, 0.0f);
      return geometry.intersect(leaves.ray, 0.0f, leaves.departure);
    };
    again += next(top, true).has_value();
    const auto bottom = next(top, false);
    if (!bottom) {
      passed_over += thin ? 1 : 0;
      continue;
    }
    stuck += dot(bottom->normal, top.normal) > -0.99f;
    again += next(*bottom, true).has_value();
    const auto back = next(*bottom, false);
    stuck += back && dot(back->normal, bottom->normal) > -0.99f;
  }
  const auto name = ::testing::Message() << c.thickness << " at " << c.z << " from " << c.distance
                                         << (c.instanced ? " instanced" : "");
  EXPECT_GT(seen, 3'000) << name;
  EXPECT_EQ(wrong_first, 0) << name;
  EXPECT_EQ(passed_over, 0) << name;
  EXPECT_EQ(stuck, 0) << name;
  EXPECT_EQ(again, 0) << name;
}

TEST(Departure, BothFacesOfAPlateOfAnyThickness) {
  for (const float part : {1e-1f, 1e-3f, 1e-5f, 1e-6f, 1e-7f}) {
    for (const bool instanced : {false, true}) {
      for (const double distance : {3.0, 5e3, 1e5}) {
        expect_order({1.0f, 2.0f * part, 0.0f, distance, instanced});
      }
    }
  }
}

TEST(Departure, APaneFarFromTheOrigin) { expect_order({1.0f, 4e-3f, 5e3f, 5e3, false}); }

// Half a metre above the origin, floats are 6e-8 apart.
TEST(Departure, AsThinAsItsCoordinatesTellApart) {
  expect_order({1.0f, 1.2e-7f, 0.5f, 3.0, false});
}

TEST(Departure, ASmallBallFarAway) {
  Geometry geometry({Sphere{4e3, -3e3, 1e3, 1e-3}});
  geometry.set_close({{.reach = 1e-2f, .body = true}});
  const Double3 centre{4e3, -3e3, 1e3};
  for (std::uint32_t i = 0; i < 2'000; ++i) {
    const Vec3 out = any_direction(i, 1);
    const Hit hit{.position = (centre + 1e-3 * Double3(out)).rounded(),
                  .normal = out,
                  .surface = 0,
                  .distance = 0.0f,
                  .clearance = 1.0f,
                  .instance = Hit::kNoInstance,
                  .primitive = 0,
                  .u = 0.0f,
                  .v = 0.0f};
    const Vec3 inwards = a_direction(i, out, false);
    DepartingRay leaves = geometry.depart(hit, inwards, 0.0f);
    const auto other = geometry.intersect(leaves.ray, 0.0f, leaves.departure);
    ASSERT_TRUE(other);
    EXPECT_NEAR(other->distance, -2e-3f * dot(out, inwards), 1e-7f);
    EXPECT_GT(dot(other->normal, inwards), 0.0f);
    leaves = geometry.depart(hit, -inwards, 0.0f);
    EXPECT_FALSE(geometry.intersect(leaves.ray, 0.0f, leaves.departure));
  }
}

// A compiler may not take rounding to a float and back for nothing.
TEST(Departure, KeepsWhatRoundingTook) {
  for (std::uint32_t i = 0; i < 1'000; ++i) {
    const auto u = any_numbers(i, 1), v = any_numbers(i, 2);
    const Double3 point{u[0] + 1e-9 * v[0], u[1] + 1e-9 * v[1], u[2] + 1e-9 * v[2]};
    const DepartingRay ray = DepartingRay::from(point, {0, 0, 1});
    EXPECT_LT(max_abs(ray.departure.start(ray.ray) - point), 1e-14);
  }
}

TEST(ThinShapes, OnlyPartsThatAreCloseCount) {
  EXPECT_TRUE(may_be_thin(plate(1.0f, 1e-6f, 0.0f), 1e-5));
  EXPECT_FALSE(may_be_thin(plate(1.0f, 1e-3f, 0.0f), 1e-5));
  EXPECT_FALSE(may_be_thin(test::box(1.0f, {}), 1e-5));
  EXPECT_FALSE(may_be_thin(Sphere{0, 0, 0, 1.0}, 1e-5));
  EXPECT_TRUE(may_be_thin(Sphere{0, 0, 0, 1e-6}, 1e-5));
}

// A box that sinks into a floor crosses it; one that stands on it lies along it.
TEST(ThinShapes, WhatCrossesIsNotClose) {
  const Shape floor = quad_mesh({-3, -3, 0}, {6, 0, 0}, {0, 6, 0});
  const auto is_close = [&](double height, double angle) {
    const auto moved = test::transform({1, 1, 1}, {1, 0, 0}, angle, {0, 0, height});
    return may_be_close(floor, test::moved(test::box(1.0f, {}), moved), 1e-5);
  };
  EXPECT_TRUE(is_close(1.0, 0.0));
  EXPECT_TRUE(is_close(1.0 + 5e-6, 0.0));
  EXPECT_FALSE(is_close(1.0 + 1e-4, 0.0));
  EXPECT_FALSE(is_close(0.9, 0.0));
  EXPECT_TRUE(is_close(0.9, 0.3));   // faces at 17 degrees and at 73
  EXPECT_FALSE(is_close(0.9, 0.7));  // at 40 and 50
}

// 160,000 triangles, those at the poles smaller than the reach.
TEST(ThinShapes, FineMeshesAreThinWhereTheirBodyIs) {
  TriangleMesh ball = test::lumpy_ball(200);
  ball.vertices = ball.normals;  // without its lumps
  EXPECT_FALSE(may_be_thin(ball, 1e-2));
  const auto flat = [&](double height) {
    return test::moved(ball, test::transform({1, 1, height}, {1, 2, 3}, 0.5, {0, 0, 0}));
  };
  EXPECT_FALSE(may_be_thin(flat(0.1), 1e-5));
  EXPECT_TRUE(may_be_thin(flat(1e-6), 1e-5));
}

}  // namespace
}  // namespace nocturne

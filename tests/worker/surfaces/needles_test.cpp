// Long and thin triangles are met where a ray meets them, as exactly as others.
#include "support/needles.h"

#include <gtest/gtest.h>

#include <vector>

#include "surfaces/geometry.h"
#include "surfaces/test_shapes.h"
#include "surfaces/triangle_at.h"

namespace nocturne {
namespace {

constexpr std::uint32_t kNeedles = 100'000;
constexpr Vec3 kFrom{0.1f, 0.05f, 0.02f};

// At rest, moving and as an instance, from within.
void expect_exact_hits(const Geometry& geometry, float time) {
  const auto& mesh = std::get<TriangleMesh>(geometry.shapes()[0]);
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Ray ray{kFrom, test::any_direction(i, 1)};
    const auto hit = geometry.intersect(ray, time);
    ASSERT_TRUE(hit);
    const Corners p = corners_at(mesh, mesh.vertices, hit->primitive, time);
    const Double3 n = cross(Double3(p.b) - Double3(p.a), Double3(p.c) - Double3(p.a));
    const Double3 unit = (1.0 / length(n)) * n, d(ray.direction);
    const double way = dot(unit, Double3(p.a) - Double3(kFrom)) / dot(unit, d);
    EXPECT_LT(length(Double3(hit->position) - (Double3(kFrom) + way * d)), 1e-5);
    EXPECT_LT(length(Double3(hit->normal) - unit), 1e-6);
    EXPECT_LT(std::fabs((hit->distance - way) * dot(unit, d)), hit->clearance);
  }
}

TEST(Needles, AreMetWhereTheRayMeetsThem) {
  expect_exact_hits(Geometry({test::needles(kNeedles)}), 0.0f);
}

TEST(Needles, AreMetInAnInstanceWhereTheRayMeetsThem) {
  const Transform at_rest{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  expect_exact_hits(Geometry({test::needles(kNeedles)}, {1}, {{1, {at_rest}}}), 0.0f);
}

TEST(Needles, AreMetOnTheirWayWhereTheRayMeetsThem) {
  TriangleMesh mesh = test::needles(3000);  // Embree needs long for more of them
  const std::size_t count = mesh.vertices.size();
  for (std::size_t i = 0; i < count; ++i) {
    mesh.vertices.push_back(mesh.vertices[i] + Vec3{0.01f, 0.0f, 0.0f});
  }
  mesh.time_steps = 2;
  expect_exact_hits(Geometry({mesh}), 0.4f);
}

}  // namespace
}  // namespace nocturne

#include "surfaces/geometry.h"

#include <gtest/gtest.h>

#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

using test::any_direction;
using test::box;

TEST(Geometry, ReportsSurfacePositionAndOutwardNormal) {
  const Geometry geometry({box(1.0f, {5, 0, 0}), Sphere{0, 0, 0, 2.0}});
  const auto sphere = geometry.intersect({{-10, 0, 0}, {1, 0, 0}}, 0.0f);
  ASSERT_TRUE(sphere);
  EXPECT_EQ(sphere->surface, 1u);
  EXPECT_FLOAT_EQ(sphere->position.x, -2.0f);
  EXPECT_FLOAT_EQ(sphere->normal.x, -1.0f);
  const auto face = geometry.intersect({{20, 0.3f, 0.1f}, {-1, 0, 0}}, 0.0f);
  ASSERT_TRUE(face);
  EXPECT_EQ(face->surface, 0u);
  EXPECT_FLOAT_EQ(face->position.x, 6.0f);
  EXPECT_FLOAT_EQ(face->normal.x, 1.0f);
  EXPECT_FALSE(geometry.intersect({{0, 50, 0}, {0, 1, 0}}, 0.0f));
}

TEST(Geometry, BoundsOfNothingShownAreEmpty) {
  EXPECT_EQ(Geometry({}).bounds().radius, 0.0f);
  EXPECT_EQ(Geometry({box(1.0f, {})}, {1}, {}).bounds().radius, 0.0f);  // a group without instances
}

// From inside a closed box, at several places and sizes, no ray gets out and no ray meets the
// surface that it starts on.
TEST(Geometry, ClosedBoxLosesNoRay) {
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    for (const float offset : {0.0f, 100.0f}) {
      const Vec3 centre{offset * size, 0.5f * offset * size, 0.0f};
      const Geometry geometry({box(size, centre)});
      Ray ray{centre, any_direction(0)};
      for (std::uint32_t i = 1; i < 20'000; ++i) {
        const auto hit = geometry.intersect(ray, 0.0f);
        ASSERT_TRUE(hit) << "size " << size << " offset " << offset << " bounce " << i;
        Vec3 direction = any_direction(i);
        if (dot(direction, hit->normal) > 0.0f) direction = -direction;  // stay inside
        ray = {leave_surface(*hit, direction), direction};
        ASSERT_LT(max_abs(ray.origin - centre), 1.0001f * size);
      }
    }
  }
}

}  // namespace
}  // namespace nocturne

#include "surfaces/shading_normal.h"

#include <gtest/gtest.h>

#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

SurfaceDetail flat(Vec3 dp_du, Vec3 dp_dv) {
  SurfaceDetail d;
  d.dp_du = dp_du;
  d.dp_dv = dp_dv;
  d.geometric_normal = d.shading_normal = {0, 0, 1};
  return d;
}

void expect_near(Vec3 a, Double3 b, double tolerance) {
  EXPECT_LT(length(Double3(a) - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(MappedNormal, AxesAreThoseOfTheTexture) {
  const SurfaceDetail d = flat({0, 2, 0}, {-3, 0, 0});
  expect_near(mapped_normal(d, {0, 0, 1}), {0, 0, 1}, 1e-7);
  expect_near(mapped_normal(d, {0.6f, 0, 0.8f}), {0, 0.6, 0.8}, 1e-6);
  expect_near(mapped_normal(d, {0, 1.2f, 1.6f}), {-0.6, 0, 0.8}, 1e-6);
  // Coordinates that run the other way round.
  expect_near(mapped_normal(flat({0, 2, 0}, {3, 0, 0}), {0, 0.6f, 0.8f}), {0.6, 0, 0.8}, 1e-6);
  expect_near(mapped_normal(d, {0, 0, 0}), {0, 0, 1}, 1e-7);
}

TEST(MappedNormal, StaysInFrontOfTheSurface) {
  SurfaceDetail d = flat({1, 0, 0}, {0, 1, 0});
  d.shading_normal = normalized({0.7f, 0.2f, 0.3f});
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    const Vec3 n = mapped_normal(d, test::any_direction(i));
    EXPECT_NEAR(length(n), 1.0f, 1e-5f);
    EXPECT_GT(dot(n, d.geometric_normal), 9e-4f);
  }
  expect_near(mapped_normal(flat({1, 0, 0}, {0, 1, 0}), {0, 0, -1}), {0, 0, 1}, 1e-7);
}

// Against the normal of the displaced surface p + h(u, v) n, by differences in double precision: a
// sheared, stretched parametrisation of a plane.
TEST(BumpedNormal, IsThatOfTheDisplacedPlane) {
  const Double3 pu{0.5, 0.1, 0}, pv{-0.2, 2.0, 0};
  const SurfaceDetail d = flat(pu.rounded(), pv.rounded());
  for (std::uint32_t i = 0; i < 1'000; ++i) {
    const Vec3 g = test::any_point(i);
    Double3 n = cross(pu + static_cast<double>(g.x) * Double3{0, 0, 1},
                      pv + static_cast<double>(g.y) * Double3{0, 0, 1});
    n = (1.0 / length(n)) * n;
    expect_near(bumped_normal(d, g.x, g.y), n, 2e-6);
    // The same surface with u and v exchanged.
    const SurfaceDetail swapped = flat(pv.rounded(), pu.rounded());
    expect_near(bumped_normal(swapped, g.y, g.x), n, 2e-6);
  }
}

TEST(BumpedNormal, StaysInFrontOfTheSurface) {
  SurfaceDetail d = flat({1, 0, 0}, {0, 1, 0});
  d.shading_normal = normalized({0.9f, 0.0f, 0.1f});
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    const Vec3 g = 100.0f * test::any_point(i);
    const Vec3 n = bumped_normal(d, g.x, g.y);
    EXPECT_NEAR(length(n), 1.0f, 1e-5f);
    EXPECT_GT(dot(n, d.geometric_normal), 9e-4f);
  }
}

TEST(FrameAlong, IsRightHandedAndFollowsTheTangent) {
  for (std::uint32_t i = 0; i < 1'000; ++i) {
    const Vec3 n = test::any_direction(i, 1), along = 3.0f * test::any_direction(i, 2);
    const Frame f = frame_along(n, along);
    EXPECT_GT(dot(f.tangent, along), 0.0f);
    EXPECT_NEAR(dot(f.bitangent, along), 0.0f, 1e-5f);
    EXPECT_LT(max_abs(cross(f.tangent, f.bitangent) - n), 1e-5f);
  }
  const Frame any = frame_along({0, 0, 1}, {0, 0, 2});
  EXPECT_NEAR(length(any.tangent), 1.0f, 1e-6f);
}

}  // namespace
}  // namespace nocturne

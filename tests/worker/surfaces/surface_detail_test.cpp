#include <gtest/gtest.h>

#include "surfaces/geometry.h"
#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

// A triangle with normals and texture coordinates, seen from above.
TriangleMesh triangle() {
  return {.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}},
          .triangles = {{0, 1, 2}},
          .normals = {{0, 0, 1}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}},
          .texture_coordinates = {{0.1f, 0.2f}, {0.5f, 0.2f}, {0.1f, 1.2f}}};
}

TEST(SurfaceDetail, InterpolatesOnATriangle) {
  const Geometry geometry({triangle()});
  const auto hit = geometry.intersect({{0.5f, 0.25f, 1}, {0, 0, -1}}, 0.0f);
  ASSERT_TRUE(hit);
  const SurfaceDetail detail = geometry.detail(*hit, 0.0f);
  EXPECT_FLOAT_EQ(detail.u, 0.2f);   // 0.1 + 0.25 * 0.4
  EXPECT_FLOAT_EQ(detail.v, 0.45f);  // 0.2 + 0.25 * 1.0
  // (0.15, 0.15, 0.5 + 0.4) made a unit vector.
  const double size = std::sqrt(0.15 * 0.15 * 2 + 0.81);
  EXPECT_NEAR(detail.shading_normal.x, 0.15 / size, 1e-6);
  EXPECT_NEAR(detail.shading_normal.y, 0.15 / size, 1e-6);
  EXPECT_NEAR(detail.shading_normal.z, 0.9 / size, 1e-6);
  EXPECT_NEAR(detail.dp_du.x, 5.0, 1e-5);  // 2 m over 0.4
  EXPECT_NEAR(detail.dp_du.y, 0.0, 1e-6);
  EXPECT_NEAR(detail.dp_dv.y, 1.0, 1e-6);
  // 0.4 x 1 of texture on 2 x 1 m2.
  EXPECT_NEAR(detail.texture_per_metre, std::sqrt(0.2), 1e-6);
}

// A normal that points below the surface belongs to the other side.
TEST(SurfaceDetail, ShadingNormalIsOnTheSideOfTheGeometricOne) {
  TriangleMesh mesh = triangle();
  for (Vec3& n : mesh.normals) n = -n;
  const Geometry reversed({mesh}), right({triangle()});
  const Ray ray{{0.5f, 0.25f, 1}, {0, 0, -1}};
  const Vec3 a = reversed.detail(*reversed.intersect(ray, 0), 0).shading_normal;
  const Vec3 b = right.detail(*right.intersect(ray, 0), 0).shading_normal;
  EXPECT_EQ(max_abs(a - b), 0.0f);
}

TEST(SurfaceDetail, WithoutCoordinatesAnyFrame) {
  const Geometry geometry({test::box(1.0f, {})});
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto hit = geometry.intersect({{}, test::any_direction(i)}, 0.0f);
    const SurfaceDetail d = geometry.detail(*hit, 0.0f);
    EXPECT_EQ(d.texture_per_metre, 0.0f);
    EXPECT_EQ(max_abs(d.shading_normal - hit->normal), 0.0f);
    EXPECT_NEAR(length(d.dp_du), 1.0f, 1e-6f);
    EXPECT_LT(max_abs(cross(d.dp_du, d.dp_dv) - hit->normal), 1e-6f);
  }
  TriangleMesh same = triangle();
  same.texture_coordinates = {{0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f}};
  const Geometry degenerate({same});
  const auto hit = degenerate.intersect({{0.5f, 0.25f, 1}, {0, 0, -1}}, 0.0f);
  const SurfaceDetail d = degenerate.detail(*hit, 0.0f);
  EXPECT_FLOAT_EQ(d.u, 0.5f);
  EXPECT_NEAR(length(d.dp_du), 1.0f, 1e-6f);
}

TEST(SurfaceDetail, QuadsHaveTheirEdges) {
  const Geometry geometry({quad_mesh({1, 0, 0}, {0, 3, 0}, {0, 0, 2})});
  for (std::uint32_t i = 0; i < 1'000; ++i) {
    const auto u = test::any_numbers(i);
    const auto hit = geometry.intersect({{2, 3 * u[0], 2 * u[1]}, {-1, 0, 0}}, 0.0f);
    ASSERT_TRUE(hit);
    EXPECT_FLOAT_EQ(hit->normal.x, 1.0f);
    const SurfaceDetail d = geometry.detail(*hit, 0.0f);
    EXPECT_NEAR(d.u, u[0], 1e-6f);
    EXPECT_NEAR(d.v, u[1], 1e-6f);
    EXPECT_NEAR(d.dp_du.y, 3.0f, 1e-5f);
    EXPECT_NEAR(d.dp_dv.z, 2.0f, 1e-5f);
    EXPECT_NEAR(d.texture_per_metre, 1.0 / std::sqrt(6.0), 1e-6);
  }
}

TEST(SurfaceDetail, SpheresHaveLongitudeAndLatitude) {
  const double r = 2.5;
  const Double3 centre{1, -2, 3};
  const Geometry geometry({Sphere{1, -2, 3, r}});
  for (std::uint32_t i = 0; i < 2'000; ++i) {
    const auto q = test::any_numbers(i);
    const double phi = 2.0 * std::numbers::pi * q[0];
    const double theta = std::numbers::pi * (0.02 + 0.96 * q[1]);
    const Double3 n{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                    std::cos(theta)};
    const auto hit = geometry.intersect({(centre + 5.0 * n).rounded(), (-1.0 * n).rounded()}, 0.0f);
    ASSERT_TRUE(hit);
    const SurfaceDetail d = geometry.detail(*hit, 0.0f);
    EXPECT_NEAR(std::remainder(d.u - q[0], 1.0), 0.0, 1e-6 / std::sin(theta));
    EXPECT_NEAR(d.v, 1.0 - theta / std::numbers::pi, 1e-6);
    // Derivatives of c + r n(u, v).
    const Double3 du =
        2.0 * std::numbers::pi * r * std::sin(theta) * Double3{-std::sin(phi), std::cos(phi), 0};
    const Double3 dv = std::numbers::pi * r *
                       Double3{-std::cos(theta) * std::cos(phi), -std::cos(theta) * std::sin(phi),
                               std::sin(theta)};
    EXPECT_LT(length(Double3(d.dp_du) - du), 1e-4);
    EXPECT_LT(length(Double3(d.dp_dv) - dv), 1e-4 / std::sin(theta));
    EXPECT_NEAR(d.texture_per_metre, 1.0 / std::sqrt(length(cross(du, dv))),
                1e-5 / std::sin(theta));
  }
  const auto pole = geometry.intersect({{1, -2, 10}, {0, 0, -1}}, 0.0f);
  const SurfaceDetail d = geometry.detail(*pole, 0.0f);
  EXPECT_EQ(d.v, 1.0f);
  EXPECT_NEAR(length(d.dp_du), 1.0f, 1e-6f);
}

// Tangents move with the matrix, shading normals against it, and both stay perpendicular.
TEST(SurfaceDetail, InstancesCarryTangentsAndNormals) {
  const TriangleMesh mesh = test::lumpy_ball(12);
  for (const Double3 scale : {Double3{1, 1, 1}, {-1, 1, 1}, {0.2, 1, 4}, {1e3, -1e3, 2e3}}) {
    const Transform t = test::transform(scale, {1, 2, 3}, 0.8, {1, 2, 3});
    const Geometry geometry({mesh}, {1}, {{1, {t}}});
    const Placement placement(t);
    const Vec3 middle = test::apply(t, {}).rounded();
    for (std::uint32_t i = 0; i < 2'000; ++i) {
      const auto hit = geometry.intersect({middle, test::any_direction(i)}, 0.0f);
      ASSERT_TRUE(hit);
      const SurfaceDetail d = geometry.detail(*hit, 0.0f);
      EXPECT_GT(dot(d.shading_normal, hit->normal), 0.0f);
      const auto& c = mesh.triangles[hit->primitive];
      const double u = hit->u, v = hit->v;
      const Double3 normal = (1 - u - v) * Double3(mesh.normals[c[0]]) +
                             u * Double3(mesh.normals[c[1]]) + v * Double3(mesh.normals[c[2]]);
      // Directions that were perpendicular in the group stay perpendicular.
      const Double3 side = cross(normal, Double3{0.3, 0.5, -0.7});
      const Double3 carried = placement.linear * side;
      EXPECT_NEAR(dot(Double3(d.shading_normal), carried) / length(carried), 0.0, 1e-6);
      EXPECT_NEAR(length(d.shading_normal), 1.0f, 1e-6f);
      // On the plane of the triangle, and the chain rule along its first edge.
      const Double3 a = test::apply(t, mesh.vertices[c[0]]),
                    b = test::apply(t, mesh.vertices[c[1]]);
      const auto &ta = mesh.texture_coordinates[c[0]], &tb = mesh.texture_coordinates[c[1]];
      const Double3 edge = static_cast<double>(tb[0] - ta[0]) * Double3(d.dp_du) +
                           static_cast<double>(tb[1] - ta[1]) * Double3(d.dp_dv);
      EXPECT_LT(length(edge - (b - a)), 1e-5 * (length(d.dp_du) + length(d.dp_dv)));
    }
  }
}

}  // namespace
}  // namespace nocturne

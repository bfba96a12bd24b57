#include "surfaces/surface_detail.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "math/frame.h"
#include "math/functions.h"
#include "surfaces/octahedron.h"
#include "surfaces/triangle_at.h"

namespace nocturne {
namespace {

// As the shape has it, before an instance moves it.
struct OnShape {
  float u = 0.0f, v = 0.0f;
  std::optional<Double3> normal;
  Double3 dp_du, dp_dv;
  bool has_tangents = false;
};

Double3 interpolate(const Corners& corners, const Hit& hit) {
  const double u = hit.u, v = hit.v;
  return (1.0 - u - v) * Double3(corners.a) + u * Double3(corners.b) + v * Double3(corners.c);
}

void add_texture(const TriangleMesh& mesh, const Hit& hit, float time, OnShape& detail) {
  const auto& t = mesh.triangles[hit.primitive];
  const auto &a = mesh.texture_coordinates[t[0]], &b = mesh.texture_coordinates[t[1]],
             &c = mesh.texture_coordinates[t[2]];
  const double du1 = static_cast<double>(b[0]) - a[0], dv1 = static_cast<double>(b[1]) - a[1];
  const double du2 = static_cast<double>(c[0]) - a[0], dv2 = static_cast<double>(c[1]) - a[1];
  detail.u = static_cast<float>(a[0] + hit.u * du1 + hit.v * du2);
  detail.v = static_cast<float>(a[1] + hit.u * dv1 + hit.v * dv2);
  const double determinant = du1 * dv2 - dv1 * du2;
  if (determinant == 0.0) return;
  const Corners p = corners_at(mesh, mesh.vertices, hit.primitive, time);
  const Double3 ab = Double3(p.b) - p.a, ac = Double3(p.c) - p.a;
  detail.dp_du = (1.0 / determinant) * (dv2 * ab - dv1 * ac);
  detail.dp_dv = (1.0 / determinant) * (du1 * ac - du2 * ab);
  detail.has_tangents = true;
}

OnShape on_shape(const TriangleMesh& mesh, const Hit& hit, float time, bool) {
  OnShape detail;
  if (!mesh.normals.empty()) {
    detail.normal = interpolate(corners_at(mesh, mesh.normals, hit.primitive, time), hit);
  }
  if (!mesh.texture_coordinates.empty()) add_texture(mesh, hit, time, detail);
  return detail;
}

OnShape on_shape(const Sphere& sphere, const Hit& hit, float, bool instanced) {
  const Double3 n = instanced ? fold(hit.u, hit.v) : Double3(hit.normal);
  const double azimuth = math::atan2(n.y, n.x), off_axis = math::hypot(n.x, n.y);
  const double turns = azimuth / (2.0 * std::numbers::pi);
  OnShape detail;
  detail.u = static_cast<float>(turns < 0.0 ? turns + 1.0 : turns);
  detail.v = static_cast<float>(math::atan2(off_axis, -n.z) / std::numbers::pi);
  if (off_axis == 0.0) return detail;  // the poles
  const double r = sphere.radius;
  detail.dp_du = 2.0 * std::numbers::pi * r * Double3{-n.y, n.x, 0.0};
  detail.dp_dv =
      std::numbers::pi * r * Double3{-n.z * n.x / off_axis, -n.z * n.y / off_axis, off_axis};
  detail.has_tangents = true;
  return detail;
}

Vec3 shading_normal(const OnShape& detail, const Placement* placement, Vec3 geometric) {
  if (!detail.normal) return geometric;
  const Double3 n = placement ? placement->normal_to_scene(*detail.normal) : *detail.normal;
  const double inverse = 1.0 / length(n);
  if (!std::isfinite(inverse)) return geometric;  // opposite normals that cancel
  return ((dot(n, Double3(geometric)) < 0.0 ? -inverse : inverse) * n).rounded();
}

}  // namespace

SurfaceDetail surface_detail(const Shape& shape, const Placement* placement, const Hit& hit,
                             float time) {
  const OnShape local = std::visit(
      [&](const auto& s) { return on_shape(s, hit, time, placement != nullptr); }, shape);
  SurfaceDetail detail;
  detail.u = local.u;
  detail.v = local.v;
  detail.geometric_normal = hit.normal;
  detail.shading_normal = shading_normal(local, placement, hit.normal);
  const Double3 dp_du = placement ? placement->linear * local.dp_du : local.dp_du;
  const Double3 dp_dv = placement ? placement->linear * local.dp_dv : local.dp_dv;
  const double area = length(cross(dp_du, dp_dv));
  if (local.has_tangents && area > 0.0) {
    detail.dp_du = dp_du.rounded();
    detail.dp_dv = dp_dv.rounded();
    detail.texture_per_metre = static_cast<float>(1.0 / std::sqrt(area));
  } else {
    const Frame frame(hit.normal);
    detail.dp_du = frame.tangent;
    detail.dp_dv = frame.bitangent;
  }
  return detail;
}

}  // namespace nocturne

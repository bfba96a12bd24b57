#include "surfaces/locate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "surfaces/octahedron.h"
#include "surfaces/sphere_intersection.h"

namespace nocturne {
namespace {

Double3 on_sphere(Double3 centre, Double3 origin, Double3 direction, float distance) {
  const Double3 from_centre = origin + static_cast<double>(distance) * direction - centre;
  return from_centre.normalized();
}

// `height` is the clearance within the group.
Hit in_scene(const Placement& placement, Double3 position, Double3 normal, double height,
             const Found& found) {
  const Double3 n = placement.normal_to_scene(normal);
  const double inverse = 1.0 / length(n);
  const Double3 p = placement.point_to_scene(position);
  return {.position = p.rounded(),
          .normal = (inverse * n).rounded(),
          .surface = found.surface,
          .distance = found.distance,
          .clearance = static_cast<float>(kClearanceUnits * max_abs(p) + height * inverse),
          .instance = found.instance,
          .primitive = found.primitive,
          .u = found.u,
          .v = found.v};
}

Hit locate_in_group(const TriangleMesh& mesh, const Placement& placement, Double3 origin,
                    Double3 direction, Found found, float time) {
  const Corners corners = corners_at(mesh, mesh.vertices, found.primitive, time);
  const Double3 a = corners.a;
  const Double3 ab = Double3(corners.b) - a, ac = Double3(corners.c) - a;
  const Double3 n = cross(ab, ac);
  const double twice_the_area = length(n), edge = std::fmax(max_abs(ab), max_abs(ac));
  if (is_needle(edge, twice_the_area)) {
    find_again(a, ab, ac, n, placement.point_to_group(origin), placement.inverse * direction,
               found);
  }
  const Double3 position =
      a + static_cast<double>(found.u) * ab + static_cast<double>(found.v) * ac;
  return in_scene(placement, position, (1.0 / twice_the_area) * n,
                  kClearanceUnits * (max_abs(position) + edge), found);
}

Hit locate_in_group(const Sphere& sphere, const Placement& placement, Double3 origin,
                    Double3 direction, Found found, float time) {
  const Double3 centre = centre_at(sphere, time);
  const Double3 n = on_sphere(centre, placement.point_to_group(origin),
                              placement.inverse * direction, found.distance);
  const auto [u, v] = unfold(n);
  found.u = u;
  found.v = v;
  const Double3 position = centre + sphere.radius * n;
  return in_scene(
      placement, position, n,
      kClearanceUnits * max_abs(position) + kDoubleUnits * (max_abs(centre) + sphere.radius),
      found);
}

}  // namespace

void find_again(Double3 a, Double3 ab, Double3 ac, Double3 across, Double3 origin,
                Double3 direction, Found& found) {
  const Double3 from_a = origin - a;
  const Double3 q = from_a - (dot(across, from_a) / dot(across, direction)) * direction;
  const double inverse = 1.0 / dot(across, across);
  const double u = inverse * dot(cross(q, ac), across), v = inverse * dot(cross(ab, q), across);
  if (!std::isfinite(u) || !std::isfinite(v)) return;  // along its plane
  found.u = static_cast<float>(u);
  found.v = static_cast<float>(v);
  if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) return;
  // Slightly outside of it: the nearest point of an edge.
  double nearest = std::numeric_limits<double>::infinity();
  const auto try_edge = [&](Double3 from, Double3 edge, const auto& coordinates) {
    const double part = std::clamp(dot(q - from, edge) / dot(edge, edge), 0.0, 1.0);
    const double off = length(q - from - part * edge);
    if (!(off < nearest)) return;
    nearest = off;
    std::tie(found.u, found.v) = coordinates(static_cast<float>(part));
  };
  try_edge({}, ab, [](float part) { return std::tuple(part, 0.0f); });
  try_edge({}, ac, [](float part) { return std::tuple(0.0f, part); });
  try_edge(ab, ac - ab, [](float part) { return std::tuple(1.0f - part, part); });
}

Hit locate_needle(const Corners& p, Double3 origin, Double3 direction, Found found) {
  const Double3 ab = Double3(p.b) - Double3(p.a), ac = Double3(p.c) - Double3(p.a);
  const Double3 n = cross(ab, ac);
  const double edge = std::fmax(max_abs(ab), max_abs(ac));
  find_again(p.a, ab, ac, n, origin, direction, found);
  const Vec3 position = (Double3(p.a) + double{found.u} * ab + double{found.v} * ac).rounded();
  return {.position = position,
          .normal = n.normalized().rounded(),
          .surface = found.surface,
          .distance = found.distance,
          .clearance = kClearanceUnits * (max_abs(position) + static_cast<float>(edge)),
          .instance = Hit::kNoInstance,
          .primitive = found.primitive,
          .u = found.u,
          .v = found.v};
}

Hit locate(const Sphere& sphere, Double3 origin, Double3 direction, const Found& found,
           float time) {
  const Double3 centre = centre_at(sphere, time);
  const Double3 n = on_sphere(centre, origin, direction, found.distance);
  const Vec3 position = (centre + sphere.radius * n).rounded();
  return {.position = position,
          .normal = n.rounded(),
          .surface = found.surface,
          .distance = found.distance,
          .clearance = kClearanceUnits * max_abs(position) +
                       static_cast<float>(kDoubleUnits * (max_abs(centre) + sphere.radius)),
          .instance = Hit::kNoInstance,
          .primitive = 0,
          .u = 0.0f,
          .v = 0.0f};
}

Hit locate(const Shape& shape, const Placement& placement, Double3 origin, Double3 direction,
           const Found& found, float time) {
  const auto in_group = [&](const auto& one) {
    return locate_in_group(one, placement, origin, direction, found, time);
  };
  return std::visit(in_group, shape);
}

}  // namespace nocturne

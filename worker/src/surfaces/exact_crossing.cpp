#include "surfaces/exact_crossing.h"

#include <algorithm>
#include <cmath>

#include "surfaces/octahedron.h"
#include "surfaces/sphere_intersection.h"
#include "surfaces/triangle_at.h"

namespace nocturne {
namespace {

// Of normals: surfaces that only cross each other have no area in common.
constexpr double kParallel = 0.999;
// Of ExactCrossing::coordinate. Both surfaces' vertices rounded to floats.
constexpr double kRounding = 0x1p-24;
// Whoever wrote a mesh as text gave it six digits.
constexpr double kSixDigits = kClearanceUnits;

// In the space of the shape.
struct Plane {
  Double3 point, normal;
  double coordinate;
};

Plane plane_of(const TriangleMesh& mesh, std::uint32_t primitive, float time) {
  const Corners corners = corners_at(mesh, mesh.vertices, primitive, time);
  const Double3 a = corners.a, b = corners.b, c = corners.c;
  const Double3 n = cross(b - a, c - a);
  const Double3 unit = n.normalized();
  const auto largest = [&](double Double3::*axis) {
    return std::fabs(unit.*axis) *
           std::fmax(std::fabs(a.*axis), std::fmax(std::fabs(b.*axis), std::fabs(c.*axis)));
  };
  return {a, unit, largest(&Double3::x) + largest(&Double3::y) + largest(&Double3::z)};
}

bool of_one_surface(const Crossed& a, const Crossed& b) {
  return a.surface == b.surface && a.instance == b.instance;
}

bool in_one_place(std::span<const Crossed> crossed, std::size_t a, std::size_t b,
                  std::span<const CloseSurface> close) {
  const Crossed &first = crossed[a], &second = crossed[b];
  if (std::fabs(dot(first.at.normal, second.at.normal)) < kParallel) return false;
  const CloseSurface &is = close[first.surface], &other = close[second.surface];
  const double apart = std::fabs(second.at.distance - first.at.distance);
  const bool exactly = !(is.body || other.body) || is.straight || other.straight;
  const double unit = exactly ? 0.0 : is.luminaire || other.luminaire ? kRounding : kSixDigits;
  if (apart * std::fabs(first.at.facing) >
      unit * (first.at.coordinate + second.at.coordinate) + first.at.noise + second.at.noise) {
    return false;
  }
  if (of_one_surface(first, second)) {
    const bool in_order = first.at.distance <= second.at.distance;
    return !(in_order ? first : second).at.entering() && (in_order ? second : first).at.entering();
  }
  const auto nearer = [&](const Crossed& one, const Crossed& to) {
    return std::ranges::any_of(crossed, [&](const Crossed& face) {
      return of_one_surface(face, one) && face.at.entering() != one.at.entering() &&
             std::fabs(face.at.distance - to.at.distance) < apart;
    });
  };
  return !nearer(first, second) && !nearer(second, first);
}

bool is_sheet(const CloseSurface& is) { return is.straight && !is.body; }
bool is_seen_body(const CloseSurface& is) { return is.body && !is.straight; }

// Where bodies touch, nothing lies between them: then a sheet hides their boundaries.
bool lies_on(std::span<const Crossed> crossed, std::size_t sheet, std::size_t body,
             std::span<const CloseSurface> close) {
  const Crossed& boundary = crossed[body];
  if (!is_sheet(close[crossed[sheet].surface]) || !is_seen_body(close[boundary.surface]) ||
      !in_one_place(crossed, sheet, body, close)) {
    return false;
  }
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    const bool same =
        of_one_surface(crossed[i], boundary) && crossed[i].at.entering() == boundary.at.entering();
    if (!same && is_seen_body(close[crossed[i].surface]) && in_one_place(crossed, i, body, close)) {
      return false;
    }
  }
  return true;
}

}  // namespace

ExactCrossing cross_exactly(const Shape& shape, const Placement* placement, Double3 origin,
                            Double3 direction, const Found& found, float time) {
  const Double3 o = placement != nullptr ? placement->point_to_group(origin) : origin;
  const Double3 d = placement != nullptr ? placement->inverse * direction : direction;
  ExactCrossing crossing;
  const auto cross_mesh = [&](const TriangleMesh& mesh) {
    const Plane plane = plane_of(mesh, found.primitive, time);
    crossing.normal = plane.normal;
    crossing.coordinate = plane.coordinate;
    crossing.distance = dot(plane.normal, plane.point - o) / dot(plane.normal, d);
  };
  visit_shape(shape, cross_mesh, [&](const Sphere& sphere) {
    const Double3 centre = centre_at(sphere, time);
    const auto roots = cross_sphere(centre, sphere.radius, o, d);
    crossing.distance = found.distance;
    if (roots) {
      const bool near =
          std::fabs(roots->near - crossing.distance) < std::fabs(roots->far - crossing.distance);
      crossing.distance = near ? roots->near : roots->far;
    }
    const Double3 out = o + crossing.distance * d - centre;
    crossing.normal = out.normalized();
    crossing.coordinate = 0.0;
  });
  crossing.noise = kDoubleUnits * max_abs(o + crossing.distance * d);
  if (placement != nullptr) {
    const Double3 n = placement->normal_to_scene(crossing.normal);
    const double stretch = 1.0 / length(n);
    crossing.normal = stretch * n;
    crossing.coordinate *= stretch;
    crossing.noise = stretch * crossing.noise + kDoubleUnits * max_abs(placement->translation);
  }
  crossing.noise += kDoubleUnits * max_abs(origin);
  crossing.facing = dot(crossing.normal, direction);
  return crossing;
}

Double3 exact_point(const Shape& shape, const Placement* placement, const Hit& hit, float time) {
  const auto on_mesh = [&](const TriangleMesh& mesh) {
    const Corners corners = corners_at(mesh, mesh.vertices, hit.primitive, time);
    const Double3 a = corners.a;
    return a + static_cast<double>(hit.u) * (Double3(corners.b) - a) +
           static_cast<double>(hit.v) * (Double3(corners.c) - a);
  };
  const Double3 point = visit_shape(shape, on_mesh, [&](const Sphere& sphere) {
    const Double3 n = placement != nullptr ? fold(hit.u, hit.v) : Double3(hit.normal);
    return centre_at(sphere, time) + (sphere.radius / length(n)) * n;
  });
  return placement != nullptr ? placement->point_to_scene(point) : point;
}

bool share_corner(const TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  for (const std::uint32_t i : mesh.triangles[a]) {
    for (const std::uint32_t j : mesh.triangles[b]) {
      const Vec3 p = mesh.vertices[i], q = mesh.vertices[j];
      if (p.x == q.x && p.y == q.y && p.z == q.z) return true;
    }
  }
  return false;
}

bool touch(std::span<const Crossed> crossed, std::size_t a, std::size_t b,
           std::span<const CloseSurface> close) {
  return in_one_place(crossed, a, b, close) && !sheet_order(crossed, a, b, close);
}

std::optional<bool> sheet_order(std::span<const Crossed> crossed, std::size_t a, std::size_t b,
                                std::span<const CloseSurface> close) {
  if (lies_on(crossed, a, b, close)) return crossed[b].at.entering();
  if (lies_on(crossed, b, a, close)) return !crossed[a].at.entering();
  return std::nullopt;
}

bool same_crossing(const Shape& shape, const Crossed& left, const Crossed& again) {
  if (!of_one_surface(left, again)) return false;
  const bool same_way = left.at.entering() == again.at.entering();
  const auto on_mesh = [&](const TriangleMesh& mesh) {
    if (left.primitive == again.primitive) return true;
    if (!same_way) return false;
    const double gap = std::fabs((again.at.distance - left.at.distance) * again.at.facing);
    return share_corner(mesh, left.primitive, again.primitive) ||
           gap <= kRounding * (left.at.coordinate + again.at.coordinate) + left.at.noise +
                      again.at.noise;
  };
  return visit_shape(shape, on_mesh, [&](const Sphere&) { return same_way; });
}

}  // namespace nocturne

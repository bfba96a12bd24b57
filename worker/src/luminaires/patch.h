// A flat piece of a luminaire, triangle or parallelogram, as something to point at. From afar a
// point is drawn uniformly over its area; from close by, where the density of that varies a lot
// over direction, uniformly over the solid angle (spherical_triangle.h).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "luminaires/on_half_line.h"
#include "math/double3.h"
#include "surfaces/hit.h"

namespace nocturne {

struct Patch {
  // corner + u edge_u + v edge_v; u, v in [0, 1], for a triangle also u + v <= 1. In double
  // precision, as a needle's width is small compared with its corner: else its plane is turned off
  // its corners, and neighbours overlap.
  Vec3 corner;
  Double3 edge_u, edge_v;
  Double3 across;          // edge_u x edge_v: the side that emits
  Double3 dual_u, dual_v;  // u = q . dual_u for q in the plane, from the corner
  Vec3 normal;             // the same as across
  Vec3 centre;
  Vec3 unit_normal;
  float longest_edge;
  float near2;  // square of the distance up to which solid angle is used; < 0: no area
  bool triangle, two_sided;

  static Patch make(Vec3 corner, Double3 edge_u, Double3 edge_v, bool triangle, bool two_sided);

  bool has_area() const { return near2 > 0.0f; }
  float area() const { return (triangle ? 0.5f : 1.0f) * length(normal); }

  /// A direction from the position, by two uniform numbers; empty where there is none.
  std::optional<ElementSample> draw(Vec3 position, float u1, float u2) const {
    if (!has_area()) return std::nullopt;
    const Vec3 to_centre = centre - position;
    const float height = dot(corner - position, normal);
    if (!two_sided && height >= 0.0f) return std::nullopt;
    if (dot(to_centre, to_centre) < near2) {
      if (const auto near = draw_near(position, u1, u2)) return near;
    }
    float u = u1, v = u2;
    if (triangle) {
      const float root = std::sqrt(u1);
      u = 1.0f - root;
      v = u2 * root;
    }
    const Vec3 point = (Double3(corner) + u * edge_u + v * edge_v).rounded();
    const Vec3 to = point - position;
    const float distance = length(to);
    const Vec3 direction = (1.0f / distance) * to;
    const float towards = dot(direction, normal);
    if (!(distance > 0.0f) || !(two_sided ? towards != 0.0f : towards < 0.0f)) return std::nullopt;
    return ElementSample{direction, by_area(distance, towards), distance, meet(point, distance)};
  }
  std::optional<DrawnDirection> sample(Vec3 position, float u1, float u2) const {
    const auto drawn = draw(position, u1, u2);
    if (!drawn) return std::nullopt;
    return DrawnDirection{drawn->direction, drawn->pdf};
  }

  /// Density of `sample`, 1/sr.
  float pdf(Vec3 position, Vec3 direction) const { return along(position, direction).pdf; }

  /// The same, and how far off it is.
  OnHalfLine along(Vec3 position, Vec3 direction) const {
    const float towards = dot(direction, normal);
    if (!two_sided && towards >= 0.0f) return {};
    // In double precision: from afar float would leave gaps between the triangles of a small lamp,
    // and a direction drawn into one would have no density.
    const Double3 to_corner = Double3(corner) - Double3(position), along(direction);
    const double t = dot(to_corner, across) / dot(along, across);
    if (!(t > 0.0) || std::isinf(t)) return {};  // behind, or parallel (NaN and infinity)
    const Double3 q = t * along - to_corner;
    const double u = dot(q, dual_u), v = dot(q, dual_v);
    if (!(u >= 0.0 && v >= 0.0) || (triangle ? u + v > 1.0 : (u > 1.0 || v > 1.0))) return {};
    const auto distance = static_cast<float>(t);
    const Vec3 to_centre = centre - position;
    if (dot(to_centre, to_centre) < near2) {
      if (const float near = near_pdf(position); near > 0.0f) return {near, distance};
    }
    return {by_area(distance, towards), distance};
  }

  /// Of a point on it. Clearance as of a hit (surfaces/hit.h).
  ElementPoint point_at(Vec3 position, Vec3 direction, float distance) const {
    return meet(position + distance * direction, distance);
  }

 private:
  // distance^2 / (area cosine), with the normal's length in both.
  float by_area(float distance, float towards) const {
    return (triangle ? 2.0f : 1.0f) * distance * distance / std::fabs(towards);
  }
  ElementPoint meet(Vec3 point, float distance) const {
    return {unit_normal, kClearanceUnits * (max_abs(point) + longest_edge + distance)};
  }

  // By solid angle; empty and zero where that can't be computed well (the same positions for both).
  std::optional<ElementSample> draw_near(Vec3 position, float u1, float u2) const;
  float near_pdf(Vec3 position) const;
};

}  // namespace nocturne

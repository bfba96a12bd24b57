// From what a search found to the hit: position, normal and clearance.
#pragma once

#include "math/double3.h"
#include "surfaces/hit.h"
#include "surfaces/instance.h"
#include "surfaces/shapes.h"
#include "surfaces/triangle_at.h"

namespace nocturne {

/// What the search found: a surface (index in the scene), and as in Hit.
struct Found {
  std::uint32_t surface, instance, primitive;
  float u, v, distance;
};

/// Whether a search's barycentric coordinates, and a normal in single precision, may be of no use:
/// their error grows with the longest edge over the triangle's width. `across` is the
/// length of the product of two edges, the longer of which is `edge` m long.
template <class Real>
bool is_needle(Real edge, Real across) {
  constexpr Real kLongest = 32;  // widths
  return edge * edge > kLongest * across;
}

/// Those of the point where the line crosses the plane of a needle, by its first corner, the edges
/// from there and their product.
void find_again(Double3 a, Double3 ab, Double3 ac, Double3 across, Double3 origin,
                Double3 direction, Found& found);

/// Of a needle in the scene itself, in double precision.
Hit locate_needle(const Corners& p, Double3 origin, Double3 direction, Found found);

/// A triangle in the scene itself, by its corners: the hot path. The point comes from the
/// barycentric coordinates: its error depends on the triangle's coordinates, not on the ray's
/// length. The line is the ray's.
inline Hit locate(const Corners& p, Double3 origin, Double3 direction, const Found& found) {
  const Vec3 ab = p.b - p.a, ac = p.c - p.a, n = cross(ab, ac);
  const float edge = std::max(max_abs(ab), max_abs(ac));
  // Also for triangles without area.
  if (is_needle(edge, length(n))) [[unlikely]]
    return locate_needle(p, origin, direction, found);
  const Vec3 position = p.a + found.u * ab + found.v * ac;
  return {.position = position,
          .normal = normalized(n),
          .surface = found.surface,
          .distance = found.distance,
          .clearance = kClearanceUnits * (max_abs(position) + edge),
          .instance = Hit::kNoInstance,
          .primitive = found.primitive,
          .u = found.u,
          .v = found.v};
}

inline Hit locate(const TriangleMesh& mesh, Double3 origin, Double3 direction, const Found& found,
                  float time) {
  return locate(corners_at(mesh, mesh.vertices, found.primitive, time), origin, direction, found);
}

/// A sphere in the scene itself. The line is the ray's.
Hit locate(const Sphere& sphere, Double3 origin, Double3 direction, const Found& found, float time);

/// A shape in an instance that stands at `placement`.
Hit locate(const Shape& shape, const Placement& placement, Double3 origin, Double3 direction,
           const Found& found, float time);

}  // namespace nocturne

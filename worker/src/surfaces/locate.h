// From what a search found to the hit: position, normal and clearance.
#pragma once

#include "math/ray.h"
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

/// A triangle in the scene itself, by its corners: the hot path. The point comes from the
/// barycentric coordinates: its error depends on the triangle's coordinates, not on the ray's
/// length.
inline Hit locate(const Corners& p, const Found& found) {
  const Vec3 ab = p.b - p.a, ac = p.c - p.a;
  const Vec3 position = p.a + found.u * ab + found.v * ac;
  return {.position = position,
          .normal = normalized(cross(ab, ac)),
          .surface = found.surface,
          .distance = found.distance,
          .clearance = kClearanceUnits * (max_abs(position) + std::max(max_abs(ab), max_abs(ac))),
          .instance = Hit::kNoInstance,
          .primitive = found.primitive,
          .u = found.u,
          .v = found.v};
}

inline Hit locate(const TriangleMesh& mesh, const Found& found, float time) {
  return locate(corners_at(mesh, mesh.vertices, found.primitive, time), found);
}

/// A sphere in the scene itself. The line is the ray's.
Hit locate(const Sphere& sphere, Double3 origin, Double3 direction, const Found& found, float time);

/// A shape in an instance that stands at `placement`.
Hit locate(const Shape& shape, const Placement& placement, Double3 origin, Double3 direction,
           const Found& found, float time);

}  // namespace nocturne

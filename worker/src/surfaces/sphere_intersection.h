#pragma once

#include <cmath>
#include <optional>

#include "math/ray.h"
#include "surfaces/shapes.h"

namespace nocturne {

/// Distances to both crossings of the line, near before far; empty where it misses. In double
/// precision, with the discriminant taken from the distance between line and centre, so that small
/// far spheres stay sharp.
struct SphereCrossings {
  double near, far;
};

inline std::optional<SphereCrossings> cross_sphere(const Sphere& s, double ox, double oy, double oz,
                                                   double dx, double dy, double dz) {
  const double fx = ox - s.x, fy = oy - s.y, fz = oz - s.z;
  const double dd = dx * dx + dy * dy + dz * dz;
  const double b = -(fx * dx + fy * dy + fz * dz) / dd;
  const double px = fx + b * dx, py = fy + b * dy, pz = fz + b * dz;
  const double discriminant = s.radius * s.radius - (px * px + py * py + pz * pz);
  if (discriminant < 0.0) return std::nullopt;
  const double half = std::sqrt(discriminant / dd);
  return SphereCrossings{b - half, b + half};
}

}  // namespace nocturne

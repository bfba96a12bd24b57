#pragma once

#include <cmath>
#include <optional>

#include "math/double3.h"
#include "math/time_steps.h"
#include "surfaces/shapes.h"

namespace nocturne {

inline Double3 centre_at_step(const Sphere& s, std::size_t step) {
  return step == 0 ? Double3{s.x, s.y, s.z} : s.later_centres[step - 1];
}

inline Double3 centre_at(const Sphere& s, float time) {
  if (s.later_centres.empty()) return {s.x, s.y, s.z};
  const TimeSegment segment = segment_at(time, s.later_centres.size() + 1);
  const Double3 from = centre_at_step(s, segment.first);
  return from +
         static_cast<double>(segment.fraction) * (centre_at_step(s, segment.first + 1) - from);
}

/// Distances to both crossings of the line, near before far; empty where it misses. In double
/// precision, with the discriminant taken from the distance between line and centre, so that small
/// far spheres stay sharp.
struct SphereCrossings {
  double near, far;
};

inline std::optional<SphereCrossings> cross_sphere(Double3 centre, double radius, Double3 origin,
                                                   Double3 direction) {
  const Double3 f = origin - centre;
  const double dd = dot(direction, direction);
  const double b = -dot(f, direction) / dd;
  const Double3 p = f + b * direction;
  const double discriminant = radius * radius - dot(p, p);
  if (discriminant < 0.0) return std::nullopt;
  const double half = std::sqrt(discriminant / dd);
  return SphereCrossings{b - half, b + half};
}

/// Of a sphere at rest.
inline std::optional<SphereCrossings> cross_sphere(const Sphere& s, double ox, double oy, double oz,
                                                   double dx, double dy, double dz) {
  return cross_sphere({s.x, s.y, s.z}, s.radius, {ox, oy, oz}, {dx, dy, dz});
}

}  // namespace nocturne

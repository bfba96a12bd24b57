// A sphere of a luminaire as something to point at: directions uniform over the cone that it fills,
// a little widened (kDirectionRounding), or over all directions from inside.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "luminaires/light_sampling_context.h"
#include "luminaires/on_half_line.h"
#include "math/constants.h"
#include "math/frame.h"
#include "math/functions.h"
#include "pdfs/directions.h"
#include "surfaces/hit.h"
#include "surfaces/shapes.h"
#include "surfaces/sphere_intersection.h"

namespace nocturne {

struct Ball {
  Sphere sphere;
  /// Else from inside there is nothing to see.
  bool two_sided;

  /// A direction from the position, by two uniform numbers; empty where there is none.
  std::optional<ElementSample> draw(Vec3 position, float u1, float u2) const {
    const View view(sphere, position);
    if (view.inside && !two_sided) return std::nullopt;
    const Vec3 direction = view.inside ? UniformSphere::sample(u1, u2) : towards(view, u1, u2);
    const float distance = distance_to(position, direction);
    return ElementSample{direction, view.pdf(), distance, point_at(position, direction, distance)};
  }
  std::optional<DrawnDirection> sample(Vec3 position, float u1, float u2) const {
    const View view(sphere, position);
    if (view.inside && !two_sided) return std::nullopt;
    return DrawnDirection{view.inside ? UniformSphere::sample(u1, u2) : towards(view, u1, u2),
                          view.pdf()};
  }

  float pdf(Vec3 position, Vec3 direction) const { return along(position, direction).pdf; }

  OnHalfLine along(Vec3 position, Vec3 d) const {
    const View view(sphere, position);
    if (view.inside) {
      if (!two_sided) return {};
      return {view.pdf(), distance_to(position, d)};
    }
    const double along = view.x * d.x + view.y * d.y + view.z * d.z;
    const double cx = view.y * d.z - view.z * d.y, cy = view.z * d.x - view.x * d.z,
                 cz = view.x * d.y - view.y * d.x;
    const double across2 = cx * cx + cy * cy + cz * cz;
    if (!(along > 0.0)) return {};
    // Most miss it by far, and need no cone: (a + b)^2 is at most 2 a^2 + 2 b^2.
    constexpr double kRim2 = kDirectionRounding * kDirectionRounding;
    if (across2 > 2.1 * (sphere.radius * sphere.radius + kRim2 * view.distance2)) return {};
    if (across2 > view.sin2 * (along * along + across2)) return {};
    return {view.pdf(), distance_to(position, d)};
  }

  ElementPoint point_at(Vec3 position, Vec3 direction, float distance) const {
    const Vec3 point = position + distance * direction;
    const Double3 out = Double3(point) - Double3{sphere.x, sphere.y, sphere.z};
    return {((1.0 / length(out)) * out).rounded(), kClearanceUnits * (max_abs(point) + distance)};
  }

 private:
  // To its first crossing; infinite in the rim by which the cone is wider. A point of the sphere
  // itself lies off it by rounding: the crossing there is where the ray begins, not where it
  // ends.
  float distance_to(Vec3 position, Vec3 d) const {
    const auto crossings =
        cross_sphere({sphere.x, sphere.y, sphere.z}, sphere.radius, Double3(position), Double3(d));
    if (!crossings) return std::numeric_limits<float>::infinity();
    const double first = crossings->near, last = crossings->far;
    // Their product is that of the distances to the nearest and the farthest point of the sphere.
    const double clearance = kClearanceUnits * (max_abs(position) + sphere.radius);
    const bool on_it = std::fabs(first * last) <= 2.0 * clearance * sphere.radius;
    const double beyond = std::fabs(first) < std::fabs(last) ? last : first;
    const double distance = on_it ? beyond : first > 0.0 ? first : last;
    return distance > 0.0 ? static_cast<float>(distance) : std::numeric_limits<float>::infinity();
  }

  // The sphere as seen from a point.
  struct View {
    double x, y, z, distance2, sin2;  // sin2 of the cone's half angle
    bool inside;

    View(const Sphere& s, Vec3 from)
        : x(s.x - from.x), y(s.y - from.y), z(s.z - from.z), distance2(x * x + y * y + z * z) {
      inside = s.radius * s.radius >= distance2;
      const double sine = s.radius / std::sqrt(distance2) + kDirectionRounding;
      sin2 = std::min(1.0, sine * sine);
    }
    // Of the half angle, without cancellation.
    double one_minus_cosine() const { return sin2 / (1.0 + std::sqrt(1.0 - sin2)); }
    // Of directions drawn towards it, 1/sr.
    float pdf() const {
      if (inside) return UniformSphere::pdf();
      return static_cast<float>(1.0 / (2.0 * std::numbers::pi * one_minus_cosine()));
    }
  };

  // Into the cone, from outside.
  static Vec3 towards(const View& view, float u1, float u2) {
    const double drop = u1 * view.one_minus_cosine();
    const double sin_theta = std::sqrt(drop * (2.0 - drop));
    const double phi = 2.0 * std::numbers::pi * u2;
    const double inverse = 1.0 / std::sqrt(view.distance2);
    const Frame frame({static_cast<float>(view.x * inverse), static_cast<float>(view.y * inverse),
                       static_cast<float>(view.z * inverse)});
    return frame.to_world({static_cast<float>(sin_theta * math::cos(phi)),
                           static_cast<float>(sin_theta * math::sin(phi)),
                           static_cast<float>(1.0 - drop)});
  }
};

}  // namespace nocturne

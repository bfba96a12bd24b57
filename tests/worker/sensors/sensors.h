// What the sensor tests share: a frame, random numbers, and a small lamp with an answer on paper.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "math/frame.h"
#include "pdfs/directions.h"
#include "sampling/sequence.h"
#include "sensors/sensor.h"

namespace nocturne::test {

inline constexpr double kPiExact = std::numbers::pi;

/// Looks along -z, at (1, 2, 3).
inline Pose pose() { return {{1, 2, 3}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}; }

/// Looks along a direction that no axis has.
inline Pose oblique_pose() {
  const Frame frame(normalized({0.3f, -0.5f, 0.8f}));
  return {{0.2f, -0.1f, 0.4f}, frame.tangent, cross(frame.tangent, frame.normal), frame.normal};
}

inline Sensor at_rest(SensorModel model, Pose where = pose()) {
  return {std::move(model), Motion({where})};
}

inline Uniform4 uniform(std::uint32_t index, std::uint32_t stream) {
  const auto words = philox4x32({index, stream, 0, 0}, {2026u, 5u});
  return {to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])};
}

/// A parallelogram that emits radiance 1 from the side of its normal.
struct Patch {
  Vec3 corner, edge_u, edge_v;

  Vec3 normal() const { return normalized(cross(edge_u, edge_v)); }
  double area() const { return length(cross(edge_u, edge_v)); }

  /// Radiance that arrives along a ray, and from where.
  bool lights(const Ray& ray) const {
    const Vec3 n = normal();
    const float facing = dot(ray.direction, n);
    if (!(facing < 0.0f)) return false;
    const float distance = dot(corner - ray.origin, n) / facing;
    if (!(distance > 0.0f)) return false;
    const Vec3 met = ray.origin + distance * ray.direction - corner;
    const float s = dot(cross(met, edge_v), n), t = dot(cross(edge_u, met), n);
    const auto whole = static_cast<float>(area());
    return s >= 0.0f && s <= whole && t >= 0.0f && t <= whole;
  }

  /// A photon; each has flux pi x area over their number.
  Ray emit(const Uniform4& u) const {
    return {corner + u[0] * edge_u + u[1] * edge_v,
            Frame(normal()).to_world(CosineHemisphere::sample(u[2], u[3]))};
  }
};

/// Mean and variance of the mean from sums over n samples.
struct Estimate {
  double sum = 0.0, squares = 0.0;

  void add(double value) {
    sum += value;
    squares += value * value;
  }
  double mean(double n) const { return sum / n; }
  double variance(double n) const { return (squares / n - mean(n) * mean(n)) / (n - 1.0); }
};

}  // namespace nocturne::test

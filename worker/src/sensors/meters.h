// Illuminance meters at points: a pixel is one of them. What each body gets is the mean over its
// surface of what a plane there would (EN 12665:2018), so a sample is that of a plane whose normal
// is drawn from those of the body; the plane aims at light as any film does.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "math/box.h"
#include "math/constants.h"
#include "math/frame.h"
#include "math/functions.h"
#include "pdfs/directions.h"
#include "sensors/film.h"
#include "sensors/pose.h"
#include "sensors/sensor_sample.h"

namespace nocturne {

enum class MeterBody : std::uint8_t { kPlane, kCylinder, kHalfCylinder, kHalfSphere, kSphere };

/// Vectors are along the pose's right, up and forward.
struct Meter {
  /// From the pose's position, m.
  Vec3 place;
  /// Unit length: of a plane or of a half-sphere's base; of cylinders the axis.
  Vec3 normal;
  /// Unit length, across the normal: the middle of what a half cylinder faces.
  Vec3 facing;
  MeterBody body;
  /// Readings are multiplied by it: 4 makes a sphere's fluence rate.
  float factor;
};

class Meters {
 public:
  static constexpr bool kNeedsLens = true;

  /// Pixel i has meter i modulo their number.
  explicit Meters(std::vector<Meter> meters) : meters_(std::move(meters)) {
    if (meters_.empty()) throw std::invalid_argument("a sensor without meters");
    for (const Meter& meter : meters_) {
      // As a film stands off its plane.
      const float off = 0x1p-18f * max_abs(meter.place);
      extent_ = larger(extent_, {std::fabs(meter.place.x) + off, std::fabs(meter.place.y) + off,
                                 std::fabs(meter.place.z) + off});
    }
  }

  /// a, b uniform in [0, 1) choose the normal, u, v the direction.
  SensorSample sample_meter(const Pose& pose, std::uint32_t pixel, float a, float b, float u,
                            float v) const {
    const Meter& meter = meters_[pixel % meters_.size()];
    const auto world = [&](Vec3 w) {
      return w.x * pose.right + w.y * pose.up + w.z * pose.forward;
    };
    const Vec3 normal = normalized(world(normal_of(meter, a, b)));
    const Vec3 direction = Frame(normal).to_world(CosineHemisphere::sample(u, v));
    Vec3 origin = pose.position + world(meter.place);
    // So that a surface in the plane of a meter does not cover it.
    if (meter.body == MeterBody::kPlane) origin = origin + 0x1p-18f * max_abs(origin) * normal;
    return {{origin, normalized(direction)}, meter.factor * kPi, 0.0f, 0.0f, normal};
  }

  SensorSample sample(const Pose& pose, Film film, float x, float y, float u, float v) const {
    const float column = std::floor(x), row = std::floor(y);
    const auto pixel =
        static_cast<std::uint32_t>(row) * film.width + static_cast<std::uint32_t>(column);
    return sample_meter(pose, pixel, x - column, y - row, u, v);
  }

  Vec3 extent(const Pose&, Film) const { return extent_; }

 private:
  static Vec3 normal_of(const Meter& meter, float a, float b) {
    switch (meter.body) {
      case MeterBody::kCylinder:
        return around(meter, kTwoPi * a);
      case MeterBody::kHalfCylinder:
        return around(meter, kPi * (a - 0.5f));
      case MeterBody::kHalfSphere:
        return Frame(meter.normal).to_world(UniformHemisphere::sample(a, b));
      case MeterBody::kSphere:
        return UniformSphere::sample(a, b);
      case MeterBody::kPlane:
        break;
    }
    return meter.normal;
  }

  static Vec3 around(const Meter& meter, float angle) {
    return math::cos(angle) * meter.facing + math::sin(angle) * cross(meter.normal, meter.facing);
  }

  std::vector<Meter> meters_;
  Vec3 extent_{};
};

}  // namespace nocturne

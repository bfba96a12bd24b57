// The far-field intensity of a lamp (Y in cd): flux per solid angle of what leaves the sphere that
// holds it. Rows are equal steps of the angle from `forward`, columns of the angle about it from
// `right` towards `up`; a pixel measures the mean over its solid angle.
#pragma once

#include <algorithm>
#include <stdexcept>

#include "math/constants.h"
#include "math/functions.h"
#include "pdfs/directions.h"
#include "sensors/direction_grid.h"
#include "sensors/film.h"
#include "sensors/pose.h"
#include "sensors/sensor_sample.h"

namespace nocturne {

class IntensityMeter {
 public:
  static constexpr bool kNeedsLens = true;

  /// Radius of the sphere around the pose's position, metres.
  explicit IntensityMeter(float lamp_radius) : radius_(lamp_radius) {
    if (!(lamp_radius > 0.0f)) throw std::invalid_argument("an intensity meter without a radius");
  }

  /// Parallel rays in from afar: I(d) is the integral of radiance towards d over the sphere's
  /// shadow.
  SensorSample sample(const Pose& pose, Film film, float x, float y, float u, float v) const {
    const DirectionGrid grid{film};
    const DirectionGrid::Point point = grid.at(x, y);
    const auto cosine = static_cast<float>(point.cosine), sine = static_cast<float>(point.sine);
    const auto c = static_cast<float>(math::cos(point.azimuth));
    const auto s = static_cast<float>(math::sin(point.azimuth));
    const Vec3 away = c * pose.right + s * pose.up;
    const Vec3 around = c * pose.up - s * pose.right;
    const Vec3 outwards = normalized(sine * away + cosine * pose.forward);
    const Vec3 downwards = cosine * away - sine * pose.forward;
    const Vec3 disc = CosineHemisphere::sample(u, v);  // its x, y are uniform on the unit disc
    // The disc stands a little off the sphere, which the lamp may touch.
    const Vec3 start =
        kStart * radius_ * outwards + radius_ * (disc.x * downwards + disc.y * around);
    const double spread = std::max(grid.row_angle(), grid.column_angle() * point.sine);
    return {{pose.position + start, -outwards},
            kPi * radius_ * radius_,
            static_cast<float>(spread),
            0.0f};
  }

  /// A photon that leaves in a direction, unit length.
  SplatWeight receive(const Pose& pose, Film film, Vec3 direction) const {
    const DirectionGrid grid{film};
    const double along = dot(direction, pose.forward);
    const double right = dot(direction, pose.right), up = dot(direction, pose.up);
    const std::uint32_t row = grid.row(math::atan2(math::hypot(right, up), along));
    const std::uint32_t column = grid.column(math::atan2(up, right));
    return {row * film.width + column, static_cast<float>(1.0 / grid.solid_angle(row)),
            std::numeric_limits<float>::infinity()};
  }

  Vec3 extent(const Pose&, Film) const {
    // The root of kStart^2 + 1.
    const float farthest = 1.416f * radius_;
    return {farthest, farthest, farthest};
  }
  /// Samples start outside of this sphere, m.
  float radius() const { return radius_; }

 private:
  static constexpr float kStart = 1.0f + 0x1p-10f;

  float radius_;
};

}  // namespace nocturne

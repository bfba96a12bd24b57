// All directions from one point; a pixel measures the mean radiance over its solid angle. Rows are
// equal steps of the angle from `up` down, columns of the azimuth, with `forward` in the middle.
#pragma once

#include <algorithm>
#include <optional>

#include "math/functions.h"
#include "sensors/direction_grid.h"
#include "sensors/film.h"
#include "sensors/pose.h"
#include "sensors/sensor_sample.h"

namespace nocturne {

struct Panorama {
  static constexpr bool kNeedsLens = false;

  SensorSample sample(const Pose& pose, Film film, float x, float y, float, float) const {
    const DirectionGrid grid{film};
    const DirectionGrid::Point point = grid.at(x, y);
    // The azimuth counts from behind over the left, so that `forward` is half a turn away.
    const auto behind = static_cast<float>(-point.sine * math::cos(point.azimuth));
    const auto left = static_cast<float>(-point.sine * math::sin(point.azimuth));
    const Vec3 direction =
        behind * pose.forward + left * pose.right + static_cast<float>(point.cosine) * pose.up;
    const double spread = std::max(grid.row_angle(), grid.column_angle() * point.sine);
    return {{pose.position, normalized(direction)}, 1.0f, static_cast<float>(spread), 0.0f};
  }

  Vec3 extent(const Pose&, Film) const { return {0.0f, 0.0f, 0.0f}; }

  /// Where the film sees a direction of any length.
  FilmPoint film_point(const Pose& pose, Film film, Vec3 direction) const {
    const Angles angles = angles_of(pose, direction);
    return DirectionGrid{film}.film_point(angles.polar, angles.azimuth);
  }

  std::optional<CameraConnection> connect(const Pose& pose, Film film, Vec3 place, float,
                                          float) const {
    const Vec3 seen = place - pose.position;
    const float distance = length(seen);
    if (!(distance > 0.0f)) return std::nullopt;
    const DirectionGrid grid{film};
    const Angles angles = angles_of(pose, seen);
    const std::uint32_t row = grid.row(angles.polar), column = grid.column(angles.azimuth);
    const double area = grid.solid_angle(row) * static_cast<double>(distance) * distance;
    return CameraConnection{(-1.0f / distance) * seen, distance, row * film.width + column,
                            static_cast<float>(1.0 / area)};
  }

 private:
  /// Radians; the azimuth as in `sample`, in [-pi, pi].
  struct Angles {
    double polar, azimuth;
  };
  static Angles angles_of(const Pose& pose, Vec3 direction) {
    const double up = dot(direction, pose.up), ahead = dot(direction, pose.forward);
    const double right = dot(direction, pose.right);
    return {math::atan2(math::hypot(right, ahead), up), math::atan2(-right, -ahead)};
  }
};

}  // namespace nocturne

// All directions from one point; a pixel measures the mean radiance over its solid angle. Rows are
// equal steps of the angle from `up` down, columns of the azimuth, with `forward` in the middle.
#pragma once

#include <algorithm>
#include <cmath>

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
    const auto behind = static_cast<float>(-point.sine * std::cos(point.azimuth));
    const auto left = static_cast<float>(-point.sine * std::sin(point.azimuth));
    const Vec3 direction =
        behind * pose.forward + left * pose.right + static_cast<float>(point.cosine) * pose.up;
    const double spread = std::max(grid.row_angle(), grid.column_angle() * point.sine);
    return {{pose.position, normalized(direction)}, 1.0f, static_cast<float>(spread), 0.0f};
  }
};

}  // namespace nocturne

// Radiance through a disc, inside a cone around `forward`: flux over etendue, so directions count
// by the cosine of their angle to `forward`. All pixels measure the same.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "math/constants.h"
#include "math/functions.h"
#include "pdfs/directions.h"
#include "sensors/film.h"
#include "sensors/pose.h"
#include "sensors/sensor_sample.h"

namespace nocturne {

class RadianceMeter {
 public:
  static constexpr bool kNeedsLens = true;

  /// Diameter of the disc, metres, > 0; half angle of the cone, (0, pi/2].
  RadianceMeter(float diameter, float acceptance)
      : radius_(0.5f * diameter), sine_(math::sin(acceptance)) {
    if (!(diameter > 0.0f)) throw std::invalid_argument("a radiance meter without a diameter");
    if (!(acceptance > 0.0f && acceptance <= 0.5f * kPi)) {
      throw std::invalid_argument("a radiance meter with an acceptance outside (0, pi/2]");
    }
  }

  /// The place inside the pixel chooses the direction.
  SensorSample sample(const Pose& pose, Film, float x, float y, float lens_u, float lens_v) const {
    const Vec3 disc = CosineHemisphere::sample(lens_u, lens_v);  // x, y uniform on the unit disc
    const Vec3 cone = CosineHemisphere::sample(x - std::floor(x), y - std::floor(y));
    const float across = sine_ * cone.x, upwards = sine_ * cone.y;
    const float along = std::sqrt(std::max(0.0f, 1.0f - across * across - upwards * upwards));
    const Vec3 direction = along * pose.forward + across * pose.right + upwards * pose.up;
    const Vec3 point = pose.position + radius_ * (disc.x * pose.right + disc.y * pose.up);
    return {{point, normalized(direction)}, 1.0f, 0.0f, 0.0f};
  }

  Vec3 extent(const Pose&, Film) const { return {radius_, radius_, 0.0f}; }

 private:
  float radius_;
  float sine_;
};

}  // namespace nocturne

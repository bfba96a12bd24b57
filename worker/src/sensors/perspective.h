// A flat film behind a pinhole or a thin lens. A pixel measures the mean radiance over its square
// of the film, and over the lens: an ideal lens without vignetting, so that Y of a pixel is the
// luminance in cd/m2 of what it sees.
#pragma once

#include <stdexcept>
#include <utility>

#include "sensors/aperture.h"
#include "sensors/film.h"
#include "sensors/pose.h"
#include "sensors/sensor_sample.h"

namespace nocturne {

class Pinhole {
 public:
  static constexpr bool kNeedsLens = false;

  /// Tangent of half the angle between the film's top and bottom edges; > 0.
  explicit Pinhole(float tan_half_height) : tan_half_height_(tan_half_height) {
    if (!(tan_half_height > 0.0f)) throw std::invalid_argument("a sensor without a field of view");
  }

  SensorSample sample(const Pose& pose, Film film, float x, float y, float, float) const {
    const Vec3 direction = through(pose, film, x, y);
    const float shorten = 1.0f / length(direction);
    return {{pose.position, shorten * direction}, 1.0f, shorten * pixel(film), 0.0f};
  }

  /// From the pinhole to a point of the film, turned round to lie in front at distance 1.
  Vec3 through(const Pose& pose, Film film, float x, float y) const {
    const float scale = pixel(film);
    const float horizontal = (x - 0.5f * static_cast<float>(film.width)) * scale;
    const float vertical = (0.5f * static_cast<float>(film.height) - y) * scale;
    return pose.forward + horizontal * pose.right + vertical * pose.up;
  }

  /// Edge of a pixel at distance 1.
  float pixel(Film film) const { return 2.0f * tan_half_height_ / static_cast<float>(film.height); }

 private:
  float tan_half_height_;
};

class ThinLens {
 public:
  static constexpr bool kNeedsLens = true;

  /// The plane in focus lies at `focus_distance` along forward, metres.
  ThinLens(Pinhole film, Aperture aperture, float focus_distance)
      : film_(film), aperture_(std::move(aperture)), focus_distance_(focus_distance) {
    if (!(focus_distance > 0.0f)) throw std::invalid_argument("a lens without a focus distance");
  }

  SensorSample sample(const Pose& pose, Film film, float x, float y, float lens_u,
                      float lens_v) const {
    const Aperture::Point point = aperture_.sample(lens_u, lens_v);
    const Vec3 lens = point.x * pose.right + point.y * pose.up;
    const Vec3 to_focus = focus_distance_ * film_.through(pose, film, x, y) - lens;
    const float shorten = 1.0f / length(to_focus);
    return {{pose.position + lens, shorten * to_focus},
            1.0f,
            shorten * focus_distance_ * film_.pixel(film),
            0.0f};
  }

 private:
  Pinhole film_;
  Aperture aperture_;
  float focus_distance_;
};

}  // namespace nocturne

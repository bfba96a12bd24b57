// A flat film behind a pinhole or a thin lens. A pixel measures the mean radiance over its square
// of the film, and over the lens: an ideal lens without vignetting, so that Y of a pixel is the
// luminance in cd/m2 of the surface that it sees.
#pragma once

#include <optional>
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

  /// Where the film sees a direction of any length; nothing for one that points backwards.
  std::optional<FilmPoint> film_point(const Pose& pose, Film film, Vec3 direction) const {
    const float along = dot(direction, pose.forward) * pixel(film);
    if (!(along > 0.0f)) return std::nullopt;
    return FilmPoint{0.5f * static_cast<float>(film.width) + dot(direction, pose.right) / along,
                     0.5f * static_cast<float>(film.height) - dot(direction, pose.up) / along};
  }

  /// From a place in front to the pinhole; lens numbers are not looked at.
  std::optional<CameraConnection> connect(const Pose& pose, Film film, Vec3 place, float,
                                          float) const {
    return way_by(pose, film, place - pose.position, place - pose.position);
  }

  /// The same through a point of a lens: `seen` is the vector from there to the place, and
  /// `through` has the direction from the lens's centre that the same point of the film sees.
  std::optional<CameraConnection> way_by(const Pose& pose, Film film, Vec3 seen,
                                         Vec3 through) const {
    const float along = dot(through, pose.forward), depth = dot(seen, pose.forward);
    if (!(along > 0.0f && depth > 0.0f)) return std::nullopt;
    const float scale = pixel(film);
    const auto index = pixel_at(film, dot(through, pose.right) / (along * scale),
                                dot(through, pose.up) / (along * scale));
    if (!index) return std::nullopt;
    const float distance = length(seen);
    // A pixel's square at distance 1 is scale^2; seen from the lens it fills scale^2 cos^3 sr.
    return CameraConnection{(-1.0f / distance) * seen, distance, *index,
                            distance / (depth * depth * depth * scale * scale)};
  }

  Vec3 extent(const Pose&, Film) const { return {0.0f, 0.0f, 0.0f}; }

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

  std::optional<CameraConnection> connect(const Pose& pose, Film film, Vec3 place, float lens_u,
                                          float lens_v) const {
    const Aperture::Point point = aperture_.sample(lens_u, lens_v);
    const Vec3 lens = point.x * pose.right + point.y * pose.up;
    const Vec3 seen = place - pose.position - lens;
    const float depth = dot(seen, pose.forward);
    return film_.way_by(pose, film, seen, lens + (focus_distance_ / depth) * seen);
  }

  Vec3 extent(const Pose&, Film) const { return {aperture_.radius(), aperture_.radius(), 0.0f}; }

 private:
  Pinhole film_;
  Aperture aperture_;
  float focus_distance_;
};

}  // namespace nocturne

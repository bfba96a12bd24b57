// A flat film that light falls on from the side that `forward` points to; a pixel measures the
// irradiance on it (Y in lx). It does not stop photons.
//
// The film stands off its plane a little (4 um for each metre of coordinate), so that a surface in
// the same plane does not cover it, and photons that end on or start from that surface are
// distinguished by more than rounding.
#pragma once

#include <optional>

#include "math/constants.h"
#include "pdfs/directions.h"
#include "sensors/film.h"
#include "sensors/orthographic.h"
#include "sensors/pose.h"
#include "sensors/sensor_sample.h"

namespace nocturne {

class Plane {
 public:
  static constexpr bool kNeedsLens = true;

  explicit Plane(FilmRectangle rectangle) : rectangle_(rectangle) {}

  /// Directions drawn in proportion to the cosine, so that their weight is pi whichever they are.
  SensorSample sample(const Pose& pose, Film film, float x, float y, float u, float v) const {
    const Vec3 w = CosineHemisphere::sample(u, v);
    const Vec3 direction = w.x * pose.right + w.y * pose.up + w.z * pose.forward;
    const Vec3 point = rectangle_.point(pose, film, x, y) + stand_off(pose, film) * pose.forward;
    return {{point, normalized(direction)}, kPi, 0.0f, rectangle_.pixel(film), pose.forward};
  }

  /// A photon that flies `distance` (metres, may be infinite) from `origin`, if that takes it
  /// through the film against `forward`.
  std::optional<SplatWeight> receive(const Pose& pose, Film film, Vec3 origin, Vec3 direction,
                                     float distance) const {
    const float approach = -dot(direction, pose.forward);
    if (!(approach > 0.0f)) return std::nullopt;
    const Vec3 from_centre = origin - pose.position;
    const float height = dot(from_centre, pose.forward) - stand_off(pose, film);
    if (!(height > 0.0f && height <= approach * distance)) return std::nullopt;
    const Vec3 met = from_centre + (height / approach) * direction;
    const float pixel = rectangle_.pixel(film);
    // A photon along the film has no point on it.
    const auto index = pixel_at(film, dot(met, pose.right) / pixel, dot(met, pose.up) / pixel);
    if (!index) return std::nullopt;
    return SplatWeight{*index, 1.0f / (pixel * pixel), height / approach};
  }

  Vec3 extent(const Pose& pose, Film film) const {
    return rectangle_.extent(film) + Vec3{0.0f, 0.0f, stand_off(pose, film)};
  }

 private:
  // Four times what leave_surface needs.
  float stand_off(const Pose& pose, Film film) const {
    const float half_size =
        0.5f * rectangle_.pixel(film) * static_cast<float>(film.width + film.height);
    return 0x1p-18f * (max_abs(pose.position) + half_size);
  }

  FilmRectangle rectangle_;
};

}  // namespace nocturne

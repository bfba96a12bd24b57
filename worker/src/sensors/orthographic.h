// A flat film without a lens that sees along `forward` only; a pixel measures the mean radiance
// over its square.
#pragma once

#include <optional>
#include <stdexcept>

#include "sensors/film.h"
#include "sensors/pose.h"
#include "sensors/sensor_sample.h"

namespace nocturne {

/// A rectangle of square pixels around the pose's position, across `forward`.
class FilmRectangle {
 public:
  /// Full height, metres; the width follows from the film.
  explicit FilmRectangle(float height) : height_(height) {
    if (!(height > 0.0f)) throw std::invalid_argument("a sensor without a height");
  }

  /// Edge of a pixel, metres.
  float pixel(Film film) const { return height_ / static_cast<float>(film.height); }

  /// Half sizes along right and up, m.
  Vec3 extent(Film film) const {
    return {0.5f * pixel(film) * static_cast<float>(film.width), 0.5f * height_, 0.0f};
  }

  Vec3 point(const Pose& pose, Film film, float x, float y) const {
    const float scale = pixel(film);
    const float horizontal = (x - 0.5f * static_cast<float>(film.width)) * scale;
    const float vertical = (0.5f * static_cast<float>(film.height) - y) * scale;
    return pose.position + horizontal * pose.right + vertical * pose.up;
  }

 private:
  float height_;
};

class Orthographic {
 public:
  static constexpr bool kNeedsLens = false;

  explicit Orthographic(FilmRectangle rectangle) : rectangle_(rectangle) {}

  SensorSample sample(const Pose& pose, Film film, float x, float y, float, float) const {
    return {{rectangle_.point(pose, film, x, y), pose.forward}, 1.0f, 0.0f, rectangle_.pixel(film)};
  }

  /// From a place in front straight back to the film.
  std::optional<CameraConnection> connect(const Pose& pose, Film film, Vec3 place, float,
                                          float) const {
    const Vec3 seen = place - pose.position;
    const float distance = dot(seen, pose.forward);
    if (!(distance > 0.0f)) return std::nullopt;
    const float pixel = rectangle_.pixel(film);
    const auto index = pixel_at(film, dot(seen, pose.right) / pixel, dot(seen, pose.up) / pixel);
    if (!index) return std::nullopt;
    return CameraConnection{-pose.forward, distance, *index, 1.0f / (pixel * pixel)};
  }

  Vec3 extent(const Pose&, Film film) const { return rectangle_.extent(film); }

 private:
  FilmRectangle rectangle_;
};

}  // namespace nocturne

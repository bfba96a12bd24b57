// The sensor of a scene: one of a closed set of models, at rest or moving over the shutter. A
// sample of a pinhole at rest is inlined; of any other it costs a call and one well-predicted jump.
#pragma once

#include <optional>
#include <utility>
#include <variant>

#include "sensors/film.h"
#include "sensors/intensity_meter.h"
#include "sensors/meters.h"
#include "sensors/orthographic.h"
#include "sensors/panorama.h"
#include "sensors/perspective.h"
#include "sensors/plane.h"
#include "sensors/pose.h"
#include "sensors/radiance_meter.h"
#include "sensors/sensor_sample.h"

namespace nocturne {

/// Each model's kNeedsLens says whether sample looks at the lens numbers.
using SensorModel = std::variant<Pinhole, ThinLens, Orthographic, Panorama, Plane, RadianceMeter,
                                 IntensityMeter, Meters>;

class Sensor {
 public:
  Sensor(SensorModel model, Motion motion) : model_(std::move(model)), motion_(std::move(motion)) {}

  /// Whether sample looks at lens_u and lens_v.
  bool needs_lens() const {
    return std::visit([](const auto& model) { return model.kNeedsLens; }, model_);
  }

  /// Whether the result depends on time.
  bool moves() const { return motion_.moves(); }

  /// Film point in pixels from the top left corner; lens numbers uniform in [0, 1); time over the
  /// shutter in [0, 1].
  SensorSample sample(Film film, float x, float y, float lens_u, float lens_v, float time) const {
    const Pinhole* pinhole = std::get_if<Pinhole>(&model_);
    if (pinhole != nullptr && !moves()) return pinhole->sample(motion_.start(), film, x, y, 0, 0);
    return sample_any(film, x, y, lens_u, lens_v, time);
  }

  /// At a point of a pixel, uniform in [0, 1)^2. Of meters that point is a number alone, and is
  /// kept whole.
  SensorSample sample_in(Film film, std::uint32_t x, std::uint32_t y, float u, float v,
                         float lens_u, float lens_v, float time) const {
    if (const Meters* meters = std::get_if<Meters>(&model_)) {
      return meters->sample_meter(motion_.at(time), y * film.width + x, u, v, lens_u, lens_v);
    }
    return sample(film, static_cast<float>(x) + u, static_cast<float>(y) + v, lens_u, lens_v, time);
  }

  /// Whether photons that start from it aim at light: its samples tell a normal.
  bool aims() const {
    return std::holds_alternative<Plane>(model_) || std::holds_alternative<Meters>(model_);
  }

  /// Whether forward photons are counted in flight, and where they leave the scene. Both are
  /// false for sensors that only adjoint photons can start from.
  bool splats_segments() const { return std::holds_alternative<Plane>(model_); }
  bool receives_escapes() const { return std::holds_alternative<IntensityMeter>(model_); }

  /// A forward photon that flies `distance` metres (may be infinite) from `origin`; nothing if it
  /// misses the film, comes from behind, or the model does not count photons in flight.
  std::optional<SplatWeight> splat_segment(Film film, Vec3 origin, Vec3 direction, float distance,
                                           float time) const {
    const Plane* plane = std::get_if<Plane>(&model_);
    if (plane == nullptr) return std::nullopt;
    return plane->receive(motion_.at(time), film, origin, direction, distance);
  }

  /// A forward photon that leaves the scene; nothing if the model does not count those.
  std::optional<SplatWeight> splat_escape(Film film, Vec3 direction, float time = 0.0f) const {
    const IntensityMeter* meter = std::get_if<IntensityMeter>(&model_);
    if (meter == nullptr) return std::nullopt;
    return meter->receive(motion_.at(time), film, direction);
  }

  /// Whether it looks out from a place, so that forward photons can be sent there.
  bool is_camera() const {
    return std::visit([](const auto& model) { return kIsCamera<decltype(model)>; }, model_);
  }

  /// From a place to a camera, through the point of the lens that the numbers choose; nothing where
  /// the film does not see the place, or the model is no camera.
  std::optional<CameraConnection> connect(Film film, Vec3 place, float lens_u, float lens_v,
                                          float time) const {
    const Pose pose = motion_.at(time);
    return std::visit(
        [&](const auto& model) -> std::optional<CameraConnection> {
          if constexpr (kIsCamera<decltype(model)>) {
            return model.connect(pose, film, place, lens_u, lens_v);
          } else {
            return std::nullopt;
          }
        },
        model_);
  }

  /// Where a camera that is at rest and sees from one place without a lens sees a direction;
  /// nothing where it does not, or for any other sensor.
  std::optional<FilmPoint> film_point(Film film, Vec3 direction) const {
    if (moves()) return std::nullopt;
    return std::visit(
        [&](const auto& model) -> std::optional<FilmPoint> {
          if constexpr (requires { model.film_point(motion_.start(), film, direction); }) {
            return model.film_point(motion_.start(), film, direction);
          } else {
            return std::nullopt;
          }
        },
        model_);
  }

  /// Of the middle of the sensor, when the shutter opens.
  Vec3 place() const { return motion_.start().position; }
  const Motion& motion() const { return motion_; }

  /// Half sizes along the pose's right, up and forward of the box around its position that samples
  /// start in, m.
  Vec3 extent(const Pose& pose, Film film) const {
    return std::visit([&](const auto& model) { return model.extent(pose, film); }, model_);
  }
  /// Around the pose's position nothing starts nearer than this, m.
  float hollow() const {
    const IntensityMeter* meter = std::get_if<IntensityMeter>(&model_);
    return meter == nullptr ? 0.0f : meter->radius();
  }

  /// Metres, to the middle of the sensor.
  float distance_from(Vec3 place, float time) const {
    return length(place - motion_.at(time).position);
  }

 private:
  template <class Model>
  static constexpr bool kIsCamera = requires(const Model& model, const Pose& pose, Film film,
                                             Vec3 place) {
    model.connect(pose, film, place, 0.0f, 0.0f);
  };

  SensorSample sample_any(Film film, float x, float y, float lens_u, float lens_v,
                          float time) const;

  SensorModel model_;
  Motion motion_;
};

}  // namespace nocturne

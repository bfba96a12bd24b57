#include "sensors/sensor.h"

namespace nocturne {

SensorSample Sensor::sample_any(Film film, float x, float y, float lens_u, float lens_v,
                                float time) const {
  const Pose pose = motion_.at(time);
  return std::visit(
      [&](const auto& model) { return model.sample(pose, film, x, y, lens_u, lens_v); }, model_);
}

}  // namespace nocturne

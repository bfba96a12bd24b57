// Keeps the forward photons that leave the sphere of an intensity meter for good, as rays.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "math/double3.h"
#include "tracer/estimators/sensor_estimator.h"
#include "tracer/trace_rays.h"

namespace nocturne {

template <int N>
class LeavingEstimator : public SensorEstimator<N> {
 public:
  LeavingEstimator(const Scene& scene, Film film)
      : SensorEstimator<N>(scene, film),
        scene_(scene),
        centre_(scene.sensor.place()),
        radius_(scene.sensor.hollow()) {}

  void on_ray(const BatchSample<N>& sample, const Group<N>& group, const Hit* hit) {
    if (hit != nullptr) return;
    const auto place = on_sphere(Double3(group.ray.origin), Double3(group.ray.direction));
    if (!place) return;
    const Vec3 at = place->rounded(), towards = group.ray.direction;
    const Spectral<N> carried = sample.flux * group.weight;
    for (std::size_t k = 0; k < N; ++k) {
      const float density = scene_.wavelengths.pdf(sample.wavelengths[k]);
      const float watts = carried[k] / (density * N);
      if (!(watts > 0.0f) || !std::isfinite(watts)) continue;
      rays_.push_back(
          {at.x, at.y, at.z, towards.x, towards.y, towards.z, watts, sample.wavelengths[k]});
    }
  }

  /// Of a batch, as they were counted; watts of one photon.
  std::vector<LeavingRay>& rays() { return rays_; }

 private:
  /// Where it leaves the sphere; nothing where it has no part of it before it.
  std::optional<Double3> on_sphere(Double3 origin, Double3 direction) const {
    const Double3 from = origin - centre_;
    const double along = dot(from, direction) / dot(direction, direction);
    const double apart = (dot(from, from) - radius_ * radius_) / dot(direction, direction);
    const double square = along * along - apart;
    if (square < 0.0) return std::nullopt;
    const double way = std::sqrt(square) - along;
    if (way < 0.0) return std::nullopt;
    return origin + way * direction;
  }

  const Scene& scene_;
  const Double3 centre_;
  const double radius_;
  std::vector<LeavingRay> rays_;
};

}  // namespace nocturne

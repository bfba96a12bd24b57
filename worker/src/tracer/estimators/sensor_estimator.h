// Counts the forward photons that meet the sensor.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "tracer/batch.h"
#include "tracer/estimators/splat.h"

namespace nocturne {

template <int N>
class SensorEstimator {
 public:
  static constexpr Transport kTransport = Transport::kForward;

  SensorEstimator(const Scene& scene, Film film) : scene_(scene), film_(film) {}

  void on_ray(const BatchSample<N>& sample, const Group<N>& group, const Hit* hit) {
    const Sensor& sensor = scene_.sensor;
    const float distance = hit != nullptr ? hit->distance : std::numeric_limits<float>::infinity();
    if (sensor.splats_segments()) {
      put(sample, group,
          sensor.splat_segment(film_, group.ray.origin, group.ray.direction, distance,
                               sample.time));
    } else if (hit == nullptr) {
      put(sample, group, sensor.splat_escape(film_, group.ray.direction, sample.time));
    }
  }
  void on_surface(const BatchSample<N>&, const Group<N>&, const Hit&) {}
  void on_medium_emission(const BatchSample<N>&, const Group<N>&, const Hit&) {}

  std::vector<Splat<N>>& splats() { return splats_; }

 private:
  void put(const BatchSample<N>& sample, const Group<N>& group,
           const std::optional<SplatWeight>& splat) {
    if (!splat) return;
    const Spectral<N> left =
        group.inside.empty() || std::isinf(splat->distance)
            ? Spectral<N>(1.0f)
            : scene_.transmittance(group.inside, splat->distance, sample.wavelengths);
    splats_.push_back({group.sample, splat->pixel,
                       splat->weight * (sample.flux * group.weight * left),
                       meets_direct_light(group), sample.light_group});
  }

  const Scene& scene_;
  const Film film_;
  std::vector<Splat<N>> splats_;
};

}  // namespace nocturne

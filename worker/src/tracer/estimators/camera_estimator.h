// Counts the forward photons that are connected to the camera.
#pragma once

#include <vector>

#include "tracer/batch.h"
#include "tracer/estimators/splat.h"

namespace nocturne {

template <int N>
class CameraEstimator {
 public:
  static constexpr Transport kTransport = Transport::kForward;

  CameraEstimator(const Scene& scene, Film film) : scene_(scene), film_(film) {}

  std::optional<CameraConnection> connect(const BatchSample<N>& sample, Vec3 place, float u,
                                          float v) const {
    return scene_.sensor.connect(film_, place, u, v, sample.time);
  }
  void on_camera_connection(const BatchSample<N>& sample, const Group<N>& group,
                            const CameraConnection& connection) {
    splats_.push_back({group.sample, connection.pixel,
                       connection.weight * (sample.flux * group.weight), meets_direct_light(group),
                       sample.light_group});
  }

  void on_ray(const BatchSample<N>&, const Group<N>&, const Hit*) {}
  void on_surface(const BatchSample<N>&, const Group<N>&, const Hit&) {}
  void on_medium_emission(const BatchSample<N>&, const Group<N>&, const Hit&) {}

  std::vector<Splat<N>>& splats() { return splats_; }

 private:
  const Scene& scene_;
  const Film film_;
  std::vector<Splat<N>> splats_;
};

}  // namespace nocturne

// Keeps where forward photons come that mirrors and clear glass gather, besides those that are
// connected to the camera.
#pragma once

#include <vector>

#include "luminaires/learned_light.h"
#include "tracer/estimators/camera_estimator.h"

namespace nocturne {

template <int N>
class ArrivalEstimator : public CameraEstimator<N> {
 public:
  ArrivalEstimator(const Scene& scene, Film film)
      : CameraEstimator<N>(scene, film), scene_(scene) {}

  void on_surface(const BatchSample<N>&, const Group<N>& group, const Hit& hit) {
    const SurfaceMaterial& material = scene_.materials[hit.surface];
    if (material.may_pass) return;
    if (scene_.specular_like[kernel_at(scene_, hit, group.ray.direction)]) return;
    keep(group, hit);
  }
  void on_medium_emission(const BatchSample<N>&, const Group<N>& group, const Hit& hit) {
    keep(group, hit);
  }

  /// On surfaces that are like diffuse ones, and in media.
  const std::vector<LearnedLight::Arrival>& arrivals() const { return arrivals_; }

 private:
  void keep(const Group<N>& group, const Hit& hit) {
    if (!group.ends.specular_like_at_luminaire || group.scattered) return;
    arrivals_.push_back({hit.position, -group.ray.direction});
  }

  const Scene& scene_;
  std::vector<LearnedLight::Arrival> arrivals_;
};

}  // namespace nocturne

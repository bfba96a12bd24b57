// Keeps where adjoint photons leave to the sky, and what they find there.
#pragma once

#include <cstdint>
#include <vector>

#include "tracer/estimators/radiance_estimator.h"

namespace nocturne {

/// Whether nothing has turned a photon since it left the sensor: windows may be between.
template <int N>
bool is_straight(const Group<N>& group) {
  constexpr float kStraight = 1e-6f;  // square of an angle that panes leave by rounding
  const Vec3 turn = group.ray.direction - group.mis.direction;
  return !group.scattered && dot(turn, turn) < kStraight;
}

template <int N>
class SkyEstimator : public RadianceEstimator<N> {
 public:
  struct Met {
    /// Number of the sample that it counts for.
    std::uint32_t tally;
    /// Unit length.
    Vec3 direction;
    bool straight;
    /// An estimate of the spectral radiance that arrives from there.
    Spectral<N> light;
  };

  /// Of photons of `suns` only those that come through count, whatever the sky's radiance.
  SkyEstimator(const Scene& scene, bool suns)
      : RadianceEstimator<N>(scene), scene_(scene), suns_(suns) {}

  void on_ray(const BatchSample<N>& sample, const Group<N>& group, const Hit* hit,
              const LightSampler::SkyTexel& place) {
    if (hit != nullptr) return;
    if (suns_) {
      if (is_straight(group)) {
        met_.push_back({group.tally, group.ray.direction, true, group.weight});
      }
      return;
    }
    const auto found = this->found_of(
        group, scene_.distant_radiance(group.ray.direction, sample.wavelengths), place);
    if (found) met_.push_back({group.tally, group.ray.direction, is_straight(group), *found});
  }
  void on_surface(const BatchSample<N>&, const Group<N>&, const Hit&) {}
  void on_medium_emission(const BatchSample<N>&, const Group<N>&, const Hit&) {}

  /// Of a batch, as they were met.
  std::vector<Met>& met() { return met_; }

 private:
  const Scene& scene_;
  const bool suns_;
  std::vector<Met> met_;
};

}  // namespace nocturne

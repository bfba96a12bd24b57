// Counts the light that photons from the sensor meet where they know how it is polarised. Where S1,
// S2 and S3 are asked for, they are counted where others count light groups.
#pragma once

#include "tracer/estimators/radiance_estimator.h"
#include "tracer/vertex/polarisation.h"

namespace nocturne {

template <int N>
class StokesEstimator : public RadianceEstimator<N> {
  using Base = RadianceEstimator<N>;

 public:
  static constexpr bool kPolarised = true;

  using Base::Base;

  void reset(std::size_t samples) {
    Base::reset(samples);
    polarisations_.clear();
  }
  /// By the batch's samples.
  std::vector<Polarisation<N>>& polarisations() { return polarisations_; }

  void on_ray(const BatchSample<N>& sample, const Group<N>& group, const Hit* hit,
              const LightSampler::SkyTexel& place) {
    if (!tells_stokes_) return Base::on_ray(sample, group, hit, place);
    if (this->nearly()) return this->nearly_meets(sample, group);
    if (hit != nullptr || !this->scene_.has_distant_light()) return;
    if (this->sightings_ != nullptr) this->keep_sighting(sample, group);
    const auto past = [&](HiddenFrom hidden) { return sees_past(group, hidden); };
    count(group,
          this->scene_.distant_radiance(group.ray.direction, sample.wavelengths, past, place),
          place);
  }

  void on_surface(const BatchSample<N>& sample, const Group<N>& group, const Hit& hit) {
    if (!tells_stokes_) return Base::on_surface(sample, group, hit);
    const Scene& scene = this->scene_;
    const SurfaceMaterial& material = scene.materials[hit.surface];
    if (material.luminaire == SurfaceMaterial::kNone) return Base::on_surface(sample, group, hit);
    const Luminaire& luminaire = scene.luminaires[material.luminaire];
    if (this->nearly() || sees_past(group, luminaire.hidden_from)) return;
    count(group,
          scene.emitted(luminaire, hit, -group.ray.direction, sample.time, sample.wavelengths));
  }

  void on_medium_emission(const BatchSample<N>& sample, const Group<N>& group, const Hit& hit) {
    if (!tells_stokes_) return Base::on_medium_emission(sample, group, hit);
    if (this->scene_.options.least_radiance > 0.0f) return;
    const Spectral<N> found =
        group.weight * this->scene_.medium(hit.surface).source(hit.position, sample.wavelengths);
    this->add(group.tally, found, meets_direct_light(group));
    const Polarisation<N>& from = polarisations_[group.sample];
    for (std::uint32_t i = 0; i < 3; ++i) {
      this->add_of_group(group.tally, i, found * from.to_sensor[i + 1][0]);
    }
  }

 private:
  void count(const Group<N>& group, const Spectral<N>& light,
             const LightSampler::SkyTexel& place = {}) {
    this->add_light(
        group, light,
        [&](const auto& f) {
          const Polarisation<N>& from = polarisations_[group.sample];
          for (std::uint32_t i = 0; i < 3; ++i) f(i, light * from.to_sensor[i + 1][0]);
        },
        place);
  }

  const bool tells_stokes_ = this->scene_.wavelengths.tells_stokes();
  std::vector<Polarisation<N>> polarisations_;
};

}  // namespace nocturne

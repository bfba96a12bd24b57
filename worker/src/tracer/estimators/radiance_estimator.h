// Counts the light that photons from the sensor meet.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "luminaires/visible_sky.h"
#include "tracer/batch.h"
#include "tracer/both_directions/near_ends.h"
#include "tracer/vertex/power_heuristic.h"

namespace nocturne {

/// Where the sky was met from surfaces.
struct SkySightings {
  std::vector<VisibleSky::Sighting> all;
  /// Photons that were sent towards lights: those that met the sky, and those that a surface
  /// stopped.
  std::uint64_t free = 0, stopped = 0;
};

template <int N>
class RadianceEstimator {
 public:
  static constexpr Transport kTransport = Transport::kAdjoint;

  explicit RadianceEstimator(const Scene& scene)
      : scene_(scene),
        tells_parts_(scene.wavelengths.tells_parts()),
        light_groups_(scene.wavelengths.light_groups()) {}

  /// From now on, with each photon that meets the sky.
  void keep_sightings(SkySightings& sightings) { sightings_ = &sightings; }

  /// The first tallies are the samples' own.
  void reset(std::size_t samples) {
    radiance_.assign(samples, {});
    if (tells_parts_) direct_.assign(samples, {});
    of_groups_.assign(samples * light_groups_, {});
  }
  std::uint32_t add_tally() {
    radiance_.emplace_back();
    if (tells_parts_) direct_.emplace_back();
    of_groups_.resize(of_groups_.size() + light_groups_);
    return static_cast<std::uint32_t>(radiance_.size() - 1);
  }
  bool found(std::uint32_t tally) const {
    return std::ranges::any_of(radiance_[tally], [](double each) { return each != 0.0; });
  }
  /// A sample's part of another tally.
  void take(std::size_t sample, std::uint32_t tally, const Spectral<N>& factor) {
    add_scaled(radiance_[sample], factor, radiance_[tally]);
    if (tells_parts_) add_scaled(direct_[sample], factor, direct_[tally]);
    for (std::uint32_t light_group = 0; light_group < light_groups_; ++light_group) {
      add_scaled(of_group(sample, light_group), factor, of_group(tally, light_group));
    }
  }

  /// Its place in the environment where that was looked up.
  void on_ray(const BatchSample<N>& sample, const Group<N>& group, const Hit* hit,
              const LightSampler::SkyTexel& place) {
    if (nearly()) return nearly_meets(sample, group);
    if (hit != nullptr || !scene_.has_distant_light()) return;
    if (sightings_ != nullptr) keep_sighting(sample, group);
    const auto past = [&](HiddenFrom hidden) { return sees_past(group, hidden); };
    const auto each_group = [&](const auto& f) {
      scene_.for_each_distant_group(group.ray.direction, sample.wavelengths, past, place, f);
    };
    add_light(group, scene_.distant_radiance(group.ray.direction, sample.wavelengths, past, place),
              each_group, place);
  }

  void on_surface(const BatchSample<N>& sample, const Group<N>& group, const Hit& hit) {
    const SurfaceMaterial& material = scene_.materials[hit.surface];
    const std::uint32_t luminaire = material.luminaire;
    if (luminaire == SurfaceMaterial::kNone) {
      const bool towards = group.mis.technique == MisTechnique::kLights;
      if (sightings_ != nullptr && towards && !material.may_pass) ++sightings_->stopped;
      return;
    }
    if (nearly()) return;
    if (sees_past(group, scene_.luminaires[luminaire].hidden_from)) return;
    if (brought_from_luminaire(group, hit.position)) return;
    const Spectral<N> light = scene_.emitted(scene_.luminaires[luminaire], hit,
                                             -group.ray.direction, sample.time, sample.wavelengths);
    add_light(group, light,
              [&](const auto& f) { f(scene_.luminaires[luminaire].light_group, light); });
  }

  /// No photon towards lights could have counted it.
  void on_medium_emission(const BatchSample<N>& sample, const Group<N>& group, const Hit& hit) {
    if (scene_.options.least_radiance > 0.0f) return;
    const Spectral<N> found =
        group.weight * scene_.medium(hit.surface).source(hit.position, sample.wavelengths);
    add(group.tally, found, meets_direct_light(group));
    if (light_groups_ > 0) add_of_group(group.tally, kUngrouped, found);
  }

  void add(std::uint32_t tally, const Spectral<N>& found, bool direct) {
    add_to(radiance_[tally], found);
    if (tells_parts_ && direct) add_to(direct_[tally], found);
  }

  /// The part of a light group; only where these are kept separate.
  void add_of_group(std::uint32_t tally, std::uint32_t light_group, const Spectral<N>& found) {
    add_to(of_group(tally, light_group), found);
  }

  /// What each photon of a sample found: an estimate of spectral radiance at its wavelength, W m-2
  /// sr-1 nm-1.
  Spectral<N> radiance(std::size_t sample) const { return rounded(radiance_[sample]); }

  /// What of it is of a light group, or else direct; only where some response counts that.
  Spectral<N> radiance(std::size_t sample, const CountedLight& light) const {
    return rounded(light.group ? of_group(sample, *light.group) : direct_[sample]);
  }

 protected:
  /// What a photon finds of light that it meets, with the MIS weight of the technique that met it.
  /// Empty where it does not count.
  std::optional<Spectral<N>> found_of(const Group<N>& group, const Spectral<N>& light,
                                      const LightSampler::SkyTexel& place) const {
    if (!counts_for(group)) return std::nullopt;
    if (largest(light) < scene_.options.least_radiance) return std::nullopt;
    Spectral<N> found = group.weight * light;
    if (group.mis.technique == MisTechnique::kNone || !(largest(found) > 0.0f)) return found;
    // Mirrors and glass may have turned it.
    const bool as_sent = place && group.mis.direction == group.ray.direction;
    const float towards =
        scene_.lights.pdf(group.mis.context, {group.mis.direction, group.mis.drawn_pdf},
                          as_sent ? place : LightSampler::SkyTexel{});
    const bool by_kernel = group.mis.technique == MisTechnique::kKernel;
    // Drawn at a rim and rounded off it. The photon from the kernel has the whole weight there.
    if (!by_kernel && !(towards > 0.0f)) return std::nullopt;
    const Spectral<N>& kernel = group.mis.kernel_pdf;
    const Spectral<N> lights(towards);
    found *= by_kernel ? power_share(kernel, lights) : power_share(lights, kernel) / lights;
    return found;
  }

  using Tally = std::array<double, N>;
  using Gathered = TracingOptions::Gathered;
  // The light group of lights without a name.
  static constexpr std::uint32_t kUngrouped = 0;

  static void add_to(Tally& sum, const Spectral<N>& found) {
    for (std::size_t i = 0; i < N; ++i) sum[i] += static_cast<double>(found[i]);
  }
  static void add_scaled(Tally& sum, const Spectral<N>& factor, const Tally& found) {
    for (std::size_t i = 0; i < N; ++i) sum[i] += static_cast<double>(factor[i]) * found[i];
  }
  static Spectral<N> rounded(const Tally& sum) {
    Spectral<N> rounded;
    for (std::size_t i = 0; i < N; ++i) rounded[i] = static_cast<float>(sum[i]);
    return rounded;
  }

  // Whether light that a group meets is an adjoint photon's, and is of the kind asked for.
  bool counts_for(const Group<N>& group) const {
    if (both() && owner_of(group.ends) != Transport::kAdjoint) return false;
    if (scene_.options.gathered == Gathered::kWithAll) return true;
    return group.ends.specular_like_at_luminaire && is_turned(group);
  }
  // A photon that goes straight on through panes meets lamps as if nothing were there.
  static bool is_turned(const Group<N>& group) {
    constexpr float kStraight = 1e-6f;  // square of an angle that no lens leaves by chance
    if (group.mis.technique == MisTechnique::kNone) return true;
    const Vec3 turn = group.ray.direction - group.mis.direction;
    return dot(turn, turn) > kStraight;
  }

  // Photons start at luminaires, too.
  bool both() const { return scene_.options.direction == Direction::kBoth; }
  bool nearly() const { return scene_.options.gathered >= Gathered::kNearlyMet; }
  void nearly_meets(const BatchSample<N>& sample, const Group<N>& group) {
    if (!counts_for(group)) return;
    const auto reaches = [&](HiddenFrom hidden_from, Vec3 direction, float distance) {
      if (sees_past(group, hidden_from)) return false;
      const TimedRay way{{group.ray.origin, direction}, sample.time, distance};
      std::uint8_t blocked = 0;
      scene_.geometry.occluded({&way, 1}, {&blocked, 1});
      return blocked == 0;
    };
    const auto [mean, square] =
        scene_.widened_lamps.met(group.ray.origin, group.ray.direction, reaches);
    if (!(mean > 0.0f)) return;
    const bool squared = scene_.options.gathered == Gathered::kNearlyMetSquared;
    add(group.tally, squared ? square * group.weight * group.weight : mean * group.weight,
        meets_direct_light(group));
  }

  bool brought_from_luminaire(const Group<N>& group, Vec3 place) const {
    if (!both() || !group.ends.diffuse_like_at_camera) return false;
    const bool near = near_luminaire(scene_, group, place);
    return owner_of(at_luminaire(group.ends, group.depth - group.passes, near)) ==
           Transport::kForward;
  }

  Tally& of_group(std::size_t tally, std::uint32_t light_group) {
    return of_groups_[tally * light_groups_ + light_group];
  }
  const Tally& of_group(std::size_t tally, std::uint32_t light_group) const {
    return of_groups_[tally * light_groups_ + light_group];
  }

  // `each_group(f)`: f(light group, its light).
  template <class EachGroup>
  void add_light(const Group<N>& group, const Spectral<N>& light, const EachGroup& each_group,
                 const LightSampler::SkyTexel& place = {}) {
    const auto counted = found_of(group, light, place);
    if (!counted) return;
    const Spectral<N>& found = *counted;
    add(group.tally, found, meets_direct_light(group));
    if (light_groups_ == 0) return;
    each_group([&](std::uint32_t light_group, const Spectral<N>& part) {
      add_of_group(group.tally, light_group, found * ratio(part, light));
    });
  }

  // Of what meets the sky by either technique. Where the density towards lights is high already, as
  // at a bright Sun, another one is worth less.
  void keep_sighting(const BatchSample<N>& sample, const Group<N>& group) {
    const LightSamplingContext& from = group.mis.context;
    const auto& environment = scene_.lights.environment();
    if (group.mis.technique == MisTechnique::kNone || from.both_sides || !environment) return;
    const Vec3 direction = group.mis.direction;
    const float kernel = sum(group.mis.kernel_pdf) / N,
                lights = scene_.lights.pdf(from, {direction, group.mis.drawn_pdf}),
                radiance = sum(environment->radiance(group.ray.direction, sample.wavelengths)) / N,
                worth =
                    radiance * dot(from.normal, direction) / (kernel + lights) / (lights + kHigh);
    if (!(worth > 0.0f) || !std::isfinite(worth)) return;
    sightings_->all.push_back(VisibleSky::sighting(from.position, from.normal, direction, worth));
    if (group.mis.technique == MisTechnique::kLights) ++sightings_->free;
  }

  static constexpr float kHigh = 2.0f;  // 1/sr

  const Scene& scene_;
  const bool tells_parts_;
  const std::uint32_t light_groups_;
  SkySightings* sightings_ = nullptr;
  std::vector<Tally> radiance_, direct_;  // by tally
  std::vector<Tally> of_groups_;          // by tally, then light group
};

}  // namespace nocturne

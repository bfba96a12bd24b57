// Radiance from everywhere that no surface is: the same from all directions, or a map.
#pragma once

#include <optional>
#include <utility>
#include <variant>

#include "luminaires/environment_map.h"
#include "luminaires/hidden_from.h"
#include "luminaires/light_sampling_context.h"
#include "math/frame.h"
#include "pdfs/directions.h"

namespace nocturne {

class Environment {
 public:
  using Drawn = EnvironmentMap::Drawn;

  /// W m-2 sr-1 nm-1.
  explicit Environment(Spectrum constant)
      : mean_(constant.mean()), radiance_(std::move(constant)) {}
  explicit Environment(EnvironmentMap map)
      : mean_(map.mean_radiance()), radiance_(std::move(map)) {}

  HiddenFrom hidden_from = HiddenFrom::kNobody;
  std::uint32_t light_group = 0;

  /// Where in it a direction is.
  using Place = EnvironmentMap::Place;
  Place place_of(Vec3 direction) const {
    const auto* map = std::get_if<EnvironmentMap>(&radiance_);
    return map ? map->place_of(direction) : Place{};
  }
  /// The same, where the radiance there will be asked for.
  Place prefetch(Vec3 direction) const {
    const auto* map = std::get_if<EnvironmentMap>(&radiance_);
    return map ? map->prefetch(direction) : Place{};
  }

  template <int N>
  Spectral<N> radiance(Place place, const Spectral<N>& wavelengths) const {
    if (const auto* map = std::get_if<EnvironmentMap>(&radiance_)) {
      return map->radiance(map->number(place), wavelengths);
    }
    return std::get<Spectrum>(radiance_)(wavelengths);
  }

  template <int N>
  Spectral<N> radiance(Vec3 direction, const Spectral<N>& wavelengths) const {
    return radiance(place_of(direction), wavelengths);
  }
  /// The same for the drawn sample, without looking up its position.
  template <int N>
  Spectral<N> radiance(const Drawn& drawn, const Spectral<N>& wavelengths) const {
    if (const auto* map = std::get_if<EnvironmentMap>(&radiance_)) {
      return map->radiance(drawn.texel, wavelengths);
    }
    return std::get<Spectrum>(radiance_)(wavelengths);
  }

  /// Over all directions and visible wavelengths.
  double mean_radiance() const { return mean_; }

  /// A unit direction; the map in proportion to its radiance, a constant in proportion to the
  /// receiver's cosine. Three uniform numbers.
  std::optional<Drawn> draw(const LightSamplingContext& from, float choice, float u1,
                            float u2) const {
    if (!(mean_ > 0.0)) return std::nullopt;
    if (const auto* map = std::get_if<EnvironmentMap>(&radiance_)) return map->draw(from, u1, u2);
    const bool behind = from.both_sides && choice < 0.5f;
    const Vec3 direction =
        Frame(behind ? -from.normal : from.normal).to_world(CosineHemisphere::sample(u1, u2));
    if (!from.sees(direction)) return std::nullopt;
    return Drawn{direction, pdf(from, direction, {}), 0};
  }

  /// For a photon that starts there, whatever it will meet: a constant from all sides alike, as by
  /// a cosine light from across would be rare and without bounds. Two uniform numbers.
  std::optional<Drawn> draw_all_around(float u1, float u2) const {
    if (!(mean_ > 0.0)) return std::nullopt;
    if (const auto* map = std::get_if<EnvironmentMap>(&radiance_)) {
      return map->draw({.position = {}, .normal = {0.0f, 0.0f, 1.0f}, .both_sides = true}, u1, u2);
    }
    return Drawn{UniformSphere::sample(u1, u2), UniformSphere::pdf(), 0};
  }

  /// A draw whose first half is done; empty where there is no map, or nothing in it.
  using PartialSample = EnvironmentMap::PartialSample;
  std::optional<PartialSample> begin(const LightSamplingContext& from, float u1, float u2) const {
    const auto* map = mean_ > 0.0 ? std::get_if<EnvironmentMap>(&radiance_) : nullptr;
    if (!map) return std::nullopt;
    return map->begin(from, u1, u2);
  }
  std::optional<Drawn> finish(const LightSamplingContext& from, const PartialSample& draft) const {
    return std::get<EnvironmentMap>(radiance_).finish(from, draft);
  }

  /// Density of `draw`, 1/sr.
  float pdf(const LightSamplingContext& from, Vec3 direction) const {
    return pdf(from, direction, place_of(direction));
  }
  /// The same, for a direction in this place.
  float pdf(const LightSamplingContext& from, Vec3 direction, Place place) const {
    if (!(mean_ > 0.0)) return 0.0f;
    if (const auto* map = std::get_if<EnvironmentMap>(&radiance_))
      return map->pdf(from, direction, place);
    const float cosine = dot(from.normal, direction);
    if (from.both_sides) return 0.5f * kInvPi * std::fabs(cosine);
    return kInvPi * std::max(0.0f, cosine);
  }

 private:
  double mean_;
  std::variant<Spectrum, EnvironmentMap> radiance_;
};

}  // namespace nocturne

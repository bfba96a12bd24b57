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

  template <int N>
  Spectral<N> radiance(Vec3 direction, const Spectral<N>& wavelengths) const {
    if (const auto* map = std::get_if<EnvironmentMap>(&radiance_)) {
      return map->radiance(direction, wavelengths);
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
    return Drawn{direction, pdf(from, direction)};
  }

  /// For a photon that starts there, whatever it will meet: a constant from all sides alike, as by
  /// a cosine what comes from across would be rare and without bounds. Two uniform numbers.
  std::optional<Drawn> draw_all_around(float u1, float u2) const {
    if (!(mean_ > 0.0)) return std::nullopt;
    if (const auto* map = std::get_if<EnvironmentMap>(&radiance_)) {
      return map->draw({.position = {}, .normal = {0.0f, 0.0f, 1.0f}, .both_sides = true}, u1, u2);
    }
    return Drawn{UniformSphere::sample(u1, u2), UniformSphere::pdf()};
  }

  /// Density of `draw`, 1/sr.
  float pdf(const LightSamplingContext& from, Vec3 direction) const {
    if (!(mean_ > 0.0)) return 0.0f;
    if (const auto* map = std::get_if<EnvironmentMap>(&radiance_)) return map->pdf(from, direction);
    const float cosine = dot(from.normal, direction);
    if (from.both_sides) return 0.5f * kInvPi * std::fabs(cosine);
    return kInvPi * std::max(0.0f, cosine);
  }

 private:
  double mean_;
  std::variant<Spectrum, EnvironmentMap> radiance_;
};

}  // namespace nocturne

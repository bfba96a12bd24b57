// From the radiance that a group of photons found to the values that it adds to a pixel.
#pragma once

#include <algorithm>
#include <cmath>

#include "sensors/wavelengths.h"
#include "tile/tile_sums.h"

namespace nocturne {

/// The mean over a group's photons of response x radiance, for X, Y, Z and then each further
/// response but sums of others. Photons that found a value that is no radiance are left out and
/// counted.
template <int N>
class Response {
 public:
  Response(const WavelengthSampler& sampler, const WavelengthSamples<N>& wavelengths)
      : sampler_(sampler), wavelengths_(wavelengths) {}

  /// Adds `scale` times the response to a sample's values: X, Y, Z, further responses. Returns the
  /// number of photons left out.
  std::uint32_t add(const Spectral<N>& radiance, double scale, double* values) const {
    return add(
        radiance, [&](const CountedLight&) { return radiance; }, scale, values);
  }

  /// The same where `part_of(light)` of the radiance is what a further curve counts: of direct and
  /// indirect light the direct one, else that of the light groups.
  template <class PartOf>
  std::uint32_t add(const Spectral<N>& radiance, const PartOf& part_of, double scale,
                    double* values) const {
    Spectral<N> kept = radiance;
    std::uint32_t invalid_samples = 0;
    for (std::size_t k = 0; k < N; ++k) {
      if (std::isfinite(radiance[k]) && radiance[k] >= 0.0f) continue;
      kept[k] = 0.0f;
      ++invalid_samples;
    }
    for (std::size_t c = 0; c < 3; ++c) values[c] += scale * mean(wavelengths_.weight[c], kept);
    for (std::size_t c = 0; c < sampler_.counting_curves(); ++c) {
      const CountedLight& light = sampler_.light(c);
      const Spectral<N> counted = light.all() ? kept : part(light, kept, part_of(light));
      if (!(largest(size(light, counted)) > 0.0f)) continue;
      values[TileSums::kXyzValues + c] +=
          scale * mean(sampler_.further_weight(c, wavelengths_), counted);
    }
    return invalid_samples;
  }

 private:
  /// Nothing of the light that is left out.
  static Spectral<N> part(const CountedLight& light, const Spectral<N>& kept,
                          const Spectral<N>& known) {
    if (light.stokes) {  // of either sign
      return each(
          [](float all, float some) { return all > 0.0f ? std::clamp(some, -all, all) : 0.0f; },
          kept, known);
    }
    return each(
        [which = light.part](float all, float some) {
          const float found = std::min(all, some);
          return which == LightPart::kIndirect ? all - found : found;
        },
        kept, known);
  }
  static Spectral<N> size(const CountedLight& light, const Spectral<N>& counted) {
    if (!light.stokes) return counted;
    return each([](float x) { return std::fabs(x); }, counted);
  }

  static double mean(const Spectral<N>& weight, const Spectral<N>& radiance) {
    double sum = 0.0;
    for (std::size_t k = 0; k < N; ++k) sum += static_cast<double>(weight[k]) * radiance[k];
    return sum / N;
  }

  const WavelengthSampler& sampler_;
  const WavelengthSamples<N>& wavelengths_;
};

}  // namespace nocturne

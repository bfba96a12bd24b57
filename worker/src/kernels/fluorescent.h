// A diffuse surface that fluoresces: besides what Lambert's law reflects, light of one wavelength
// is absorbed and sent on at others, in all directions alike. For light of radiance L the surface
// sends, in any direction,
//   L'(out) = rho(out) L(out) + integral of Phi(in, out) L(in) d(in)
// (all L as means over the cosine), with the re-radiation matrix Phi as a sum over fluorophores,
//   Phi(in, out) = absorption(in) in emission(out), 1/nm:
// photons are counted, so that the energy of each is in / out times as much. Donaldson,
// "Spectrophotometry of fluorescent pigments", British Journal of Applied Physics 5, 1954; Wilkie
// et al., "Bispectral rendering: a model of fluorescent surface appearance", EGSR 2006.
#pragma once

#include <cstddef>
#include <vector>

#include "kernels/lambertian.h"
#include "spectrum/wavelength_density.h"

namespace nocturne {

/// Something that absorbs at some wavelengths and emits at others, in proportion.
struct Fluorophore {
  /// Of the light; and 1/nm2.
  Spectrum absorption, emission;
  /// Proportional to absorption times wavelength, the integral of which is `excitation`, nm2.
  WavelengthDensity exciting;
  float excitation;
};

/// What a surface or a medium holds of them.
struct Fluorophores {
  std::vector<Fluorophore> all;

  /// What would be emitted at each wavelength if light had the same power at all: the integral of
  /// Phi over exciting ones. May be above 1.
  template <int N>
  Spectral<N> emitted(const Spectral<N>& wavelengths) const {
    Spectral<N> together = 0.0f;
    for (const Fluorophore& f : all) together += f.excitation * f.emission(wavelengths);
    return together;
  }

  template <int N>
  struct Excitation {
    /// What may have excited each photon, nm; and Phi over the density by which that was drawn.
    Spectral<N> wavelengths, weight;
  };
  /// Wavelengths of photons that were absorbed, where these were emitted; two uniform numbers.
  /// Photons of a group draw evenly spread ones.
  template <int N>
  Excitation<N> excite(const Spectral<N>& emitted_at, float which, float u) const {
    const Spectral<N> of_all = emitted(emitted_at);
    Excitation<N> found{emitted_at, 0.0f};
    for (std::size_t k = 0; k < N; ++k) {
      const Fluorophore* by = of_all[k] > 0.0f ? choose(emitted_at[k], which * of_all[k]) : nullptr;
      if (by == nullptr) continue;
      const auto drawn = by->exciting.sample<1>(spread(u, k, N));
      const float nm = drawn.nm[0], absorption = by->absorption(nm);
      found.wavelengths[k] = nm;
      if (!(absorption > 0.0f)) continue;
      found.weight[k] = absorption * nm * drawn.inverse_density[0] * (of_all[k] / by->excitation);
    }
    return found;
  }

 private:
  // In proportion to what each emits; null where none does.
  const Fluorophore* choose(float nm, float left) const {
    const Fluorophore* last = nullptr;
    for (const Fluorophore& f : all) {
      const float here = f.excitation * f.emission(nm);
      if (!(here > 0.0f)) continue;
      last = &f;
      if (left < here) break;
      left -= here;
    }
    return last;
  }
  static float spread(float u, std::size_t k, int n) {
    const float shifted = u + static_cast<float>(k) / static_cast<float>(n);
    return shifted >= 1.0f ? shifted - 1.0f : shifted;
  }
};

/// A photon's interaction at such a surface is either a reflection or an emission, never both.
struct Fluorescent {
  Colour reflectance;
  Fluorophores fluorophores;

  static constexpr bool has_delta_lobe() { return false; }
  static constexpr bool may_transmit() { return false; }

  /// What reflects alone.
  template <int N>
  BoundLambertian<N> bind(const Shading<N>& shading) const {
    return BoundLambertian<N>(reflectance(shading.point, shading.wavelengths));
  }
};

}  // namespace nocturne

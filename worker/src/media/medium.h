// A medium: what fills a body and is hit by chance. Coefficients at a point are spectra times the
// density there.
#pragma once

#include <optional>
#include <variant>

#include "media/altitude_density.h"
#include "media/glow.h"
#include "media/grid_density.h"
#include "media/majorants.h"
#include "spectrum/spectrum.h"

namespace nocturne {

using AnyDensity = std::variant<ConstantDensity, AltitudeDensity, GridDensity>;

struct Medium {
  /// 1/m at density 1.
  Spectrum absorption, scattering;
  AnyDensity density;
  std::optional<Glow> glow = {};
  /// Where dyes may have emitted photons from the sensor, besides collisions of light; 1/m at
  /// density 1.
  std::optional<Spectrum> null_collisions = {};

  /// Of absorption and scattering, 1/m at density 1.
  template <int N>
  Spectral<N> extinction(const Spectral<N>& wavelengths_nm) const {
    return absorption(wavelengths_nm) + scattering(wavelengths_nm);
  }

  /// Of photons from the sensor, 1/m at density 1: extinction and null collisions.
  template <int N>
  Spectral<N> collisions(const Spectral<N>& wavelengths_nm) const {
    const Spectral<N> light = extinction(wavelengths_nm);
    return null_collisions ? light + (*null_collisions)(wavelengths_nm) : light;
  }

  /// Emission over extinction, W m-2 sr-1 nm-1: what a photon that meets the medium there counts.
  template <int N>
  Spectral<N> source(Vec3 position, const Spectral<N>& wavelengths_nm) const {
    if (!glow) return 0.0f;
    return each(
        [](float a, float s, float radiance) { return a > 0.0f ? a / (a + s) * radiance : 0.0f; },
        absorption(wavelengths_nm), scattering(wavelengths_nm),
        glow->radiance(position, wavelengths_nm));
  }
};

}  // namespace nocturne

// A medium: what fills a body and is hit by chance. Coefficients at a point are spectra times the
// density there.
#pragma once

#include <variant>

#include "media/altitude_density.h"
#include "media/bounds.h"
#include "spectrum/spectrum.h"

namespace nocturne {

using AnyDensity = std::variant<ConstantDensity, AltitudeDensity>;

struct Medium {
  /// 1/m at density 1.
  Spectrum absorption, scattering;
  AnyDensity density;

  /// Of absorption and scattering, 1/m at density 1.
  template <int N>
  Spectral<N> extinction(const Spectral<N>& wavelengths_nm) const {
    return absorption(wavelengths_nm) + scattering(wavelengths_nm);
  }
};

}  // namespace nocturne

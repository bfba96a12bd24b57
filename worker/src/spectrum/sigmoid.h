// Smooth spectra from three numbers: S(c0 l^2 + c1 l + c2), l in nm, S(x) = 1/2 + x / (2 sqrt(1 +
// x^2)). Jakob and Hanika, "A low-dimensional function space for efficient spectral upsampling",
// Computer Graphics Forum 38(2), 2019, equations 3 and 4.
#pragma once

#include "spectrum/spectral.h"

namespace nocturne {

/// In [0, 1], for any finite x; without cancellation where it is small.
template <int N>
Spectral<N> sigmoid(const Spectral<N>& argument) {
  const auto x = argument.lanes;
  auto a = x < 0.0f ? -x : x;
  a = a < 1e18f ? a : Spectral<N>(1e18f).lanes;  // its square must stay finite
  const auto root = sqrt(Spectral<N>(1.0f + a * a)).lanes;
  const auto small = 0.5f / (root * (root + a));
  return Spectral<N>(x < 0.0f ? small : 1.0f - small);
}
inline float sigmoid(float x) { return sigmoid(Spectral<1>(x))[0]; }

struct SigmoidSpectrum {
  float c0, c1, c2;

  template <int N>
  Spectral<N> operator()(const Spectral<N>& wavelengths_nm) const {
    return sigmoid(Spectral<N>((c0 * wavelengths_nm.lanes + c1) * wavelengths_nm.lanes + c2));
  }
  float operator()(float wavelength_nm) const { return (*this)(Spectral<1>(wavelength_nm))[0]; }
};

}  // namespace nocturne

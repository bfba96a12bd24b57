// Smooth spectra from three numbers: S(c0 l^2 + c1 l + c2), l in nm, S(x) = 1/2 + x / (2 sqrt(1 +
// x^2)). Jakob and Hanika, "A low-dimensional function space for efficient spectral upsampling",
// Computer Graphics Forum 38(2), 2019, equations 3 and 4.
#pragma once

#include <cmath>

namespace nocturne {

/// In [0, 1], for any finite x; without cancellation where it is small.
inline float sigmoid(float x) {
  const float a = std::fmin(std::fabs(x), 1e18f);  // its square must stay finite
  const float root = std::sqrt(1.0f + a * a);
  const float small = 0.5f / (root * (root + a));
  return x < 0.0f ? small : 1.0f - small;
}

struct SigmoidSpectrum {
  float c0, c1, c2;

  float operator()(float wavelength_nm) const {
    return sigmoid((c0 * wavelength_nm + c1) * wavelength_nm + c2);
  }
};

}  // namespace nocturne

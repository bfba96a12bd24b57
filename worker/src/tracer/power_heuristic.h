// What a photon counts for where another technique could have brought the same: the power heuristic
// with exponent 2 (Veach and Guibas, SIGGRAPH 1995; docs/decisions/0112).
#pragma once

#include "spectrum/spectral.h"

namespace nocturne {

/// The share of the technique that did, by both densities, 1/sr: `own` is positive, `other` not
/// negative. The shares of the two add up to one. A ratio is squared, as squares of densities leave
/// the range of floats.
template <int N>
Spectral<N> power_share(const Spectral<N>& own, const Spectral<N>& other) {
  const Spectral<N> ratio = other / own;
  return Spectral<N>(1.0f) / (Spectral<N>(1.0f) + ratio * ratio);
}

}  // namespace nocturne

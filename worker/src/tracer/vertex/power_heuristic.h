// What a photon counts for where another technique could have brought the same: the power heuristic
// with exponent 2 (Veach and Guibas, SIGGRAPH 1995; docs/decisions/0112).
#pragma once

#include "spectrum/spectral.h"

namespace nocturne {

/// The share of the technique that did, by both densities, 1/sr, not negative. The shares of the
/// two add up to one; what could not have come by `own` has none. A ratio is squared, as squares of
/// densities leave the range of floats.
template <int N>
Spectral<N> power_share(const Spectral<N>& own, const Spectral<N>& other) {
  const Spectral<N> ratio = other / own;
  const Spectral<N> share = Spectral<N>(1.0f) / (Spectral<N>(1.0f) + ratio * ratio);
  return Spectral<N>(own.lanes > 0.0f ? share.lanes : own.lanes - own.lanes);
}

}  // namespace nocturne

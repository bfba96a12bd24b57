// Adjoint photons: from the sensor to the luminaires.
#pragma once

#include "tracer/walk.h"

namespace nocturne {

template <int N>
struct GroupResult {
  /// What each photon found on luminaires: an estimate of spectral radiance at its wavelength, W
  /// m-2 sr-1 nm-1.
  Spectral<N> radiance;
  std::uint32_t rays;
};

/// Follows photons that leave the sensor together, each of one wavelength. N is 1, 4 or 8; Media
/// says whether the scene has any.
template <int N, bool Media>
GroupResult<N> trace_group(const Scene& scene, const Start<N>& start,
                           const PhotonSequence& sequence);

}  // namespace nocturne

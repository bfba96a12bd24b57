// Forward photons: from the luminaires to the sensor, by the same loop with the roles exchanged.
#pragma once

#include "sensors/film.h"
#include "tracer/walk.h"

namespace nocturne {

/// What one group adds to a pixel.
template <int N>
struct Splat {
  std::uint32_t pixel;
  /// Of each photon: an estimate of the spectral quantity that the pixel measures.
  Spectral<N> value;
};

/// Follows photons that leave a luminaire together and appends what the sensor counts to
/// `splats`. Returns the number of rays cast. N is 1, 4 or 8.
template <int N>
std::uint32_t trace_forward(const Scene& scene, Film film, float time,
                            const Spectral<N>& wavelengths_nm, const PhotonSequence& sequence,
                            std::vector<Splat<N>>& splats);

}  // namespace nocturne

// Forward photons from the luminaires, a batch at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tile/tile_sums.h"
#include "tracer/batch.h"
#include "tracer/estimators/splat.h"

namespace nocturne {

/// Photon `number` of a sample of the film.
struct PhotonIndex {
  std::uint32_t number, sample;
};

/// Estimator is SensorEstimator or CameraEstimator; N is 1, 4 or 8; Media says whether the scene
/// has any.
template <int N, class Estimator, bool Media>
class PhotonBatches {
 public:
  /// Traces up to `most` photons at once.
  PhotonBatches(const Scene& scene, Film film, std::uint32_t most, const std::stop_token& stop);

  /// Adds rays and truncated paths to `counts`.
  void trace(std::span<const PhotonIndex> photons, TileSums& counts);

  /// What they brought: by photon (index in `photons`), then as it was counted.
  const std::vector<Splat<N>>& splats() { return estimator_.splats(); }
  /// Adds a splat to the values of its pixel's sample; returns the invalid samples in it.
  std::uint32_t add(const Splat<N>& splat, double* values) const;

 private:
  const Scene& scene_;
  /// One over the photons of a sample.
  const double scale_;
  Estimator estimator_;
  Batch<N, Estimator, Media> batch_;
  std::vector<WavelengthSamples<N>> wavelengths_;
  std::vector<PixelSequence> sequences_;
};

}  // namespace nocturne

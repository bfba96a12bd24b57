// Forward photons from the luminaires, a batch at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "tile/tile_sums.h"
#include "tracer/batch.h"
#include "tracer/estimators/splat.h"

namespace nocturne {

/// Estimator is SensorEstimator, CameraEstimator, ArrivalEstimator or LeavingEstimator; N is 1 or
/// 4; Media says whether the scene has any.
template <int N, class Estimator, bool Media>
class PhotonBatches {
 public:
  PhotonBatches(const Scene& scene, Film film, const std::stop_token& stop);

  /// `count` photons from `first` on, of all of the film. Adds rays and truncated paths to
  /// `counts`.
  void trace(std::uint64_t first, std::size_t count, TileSums& counts);

  /// The splats that they brought: by photon (from 0 for `first`), then as it was counted.
  const std::vector<Splat<N>>& splats() { return estimator_.splats(); }
  const Estimator& estimator() const { return estimator_; }
  Estimator& estimator() { return estimator_; }
  /// Adds a splat to the values of its pixel's sample; returns the invalid samples in it.
  std::uint32_t add(const Splat<N>& splat, double* values) const;

 private:
  const Scene& scene_;
  /// Holds all that photons are to reach.
  const Geometry::Ball lit_;
  /// One over the photons of a sample.
  const double scale_;
  Estimator estimator_;
  Batch<N, Estimator, Media> batch_;
  std::vector<WavelengthSamples<N>> wavelengths_;
  /// Of the batch; two where it is between two sequences.
  std::vector<PixelSequence> numbers_;
};

}  // namespace nocturne

// Adjoint photons from pixels, a batch of samples at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tile/tile_sums.h"
#include "tracer/batch.h"
#include "tracer/estimators/radiance_estimator.h"
#include "tracer/pixel_sample.h"

namespace nocturne {

/// One sample of one pixel.
struct PixelIndex {
  std::uint32_t x, y, sample;
};

/// N is 1, 4 or 8; Media says whether the scene has any.
template <int N, bool Media>
class PixelBatches {
 public:
  /// Traces up to `most` samples at once.
  PixelBatches(const Scene& scene, Film film, std::uint32_t most, const std::stop_token& stop);

  /// Adds what sample i measures to the values from values[i * counts.values()] on, and rays and
  /// invalid samples to `counts`.
  void trace(std::span<const PixelIndex> samples, TileSums& counts, double* values);

 private:
  const Scene& scene_;
  const Film film_;
  RadianceEstimator<N> estimator_;
  Batch<N, RadianceEstimator<N>, Media> batch_;
  std::vector<PixelSample<N>> samples_;
  /// Of the pixels of the batch; samples of one pixel come one after the other.
  std::vector<PixelSequence> sequences_;
};

}  // namespace nocturne

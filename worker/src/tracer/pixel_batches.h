// Adjoint photons from pixels, a batch of samples at a time.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "tile/tile_sums.h"
#include "tracer/batch.h"
#include "tracer/estimators/stokes_estimator.h"
#include "tracer/pixel_sample.h"
#include "tracer/small_lights.h"

namespace nocturne {

/// One sample of one pixel.
struct PixelIndex {
  std::uint32_t x, y, sample;
  /// The first of a block of neighbours that share the light they find; all others have its
  /// wavelengths and time.
  bool leads = true;
};

/// N is 1 or 4; Media says whether the scene has any, and Polarised, whether photons know how light
/// is polarised: then as if there were media.
template <int N, bool Media, bool Polarised = false>
class PixelBatches {
 public:
  /// Traces up to `most` samples at once.
  PixelBatches(const Scene& scene, Film film, std::uint32_t most, const std::stop_token& stop);

  void keep_sightings(SkySightings& sightings) { estimator_.keep_sightings(sightings); }

  /// Adds what sample i measures to the values from values[i * counts.values()] on, and rays and
  /// invalid samples to `counts`. Blocks are whole; they share where the scene's options say so.
  void trace(std::span<const PixelIndex> samples, TileSums& counts, double* values);

 private:
  PixelSequence& sequence_of(std::uint32_t pixel);

  const Scene& scene_;
  const Film film_;
  const SmallLights small_lights_;
  using Estimator = std::conditional_t<Polarised, StokesEstimator<N>, RadianceEstimator<N>>;
  Estimator estimator_;
  Batch<N, Estimator, Media> batch_;
  std::vector<PixelSample<N>> samples_;
  /// Of the pixels of the batch, and which these are.
  std::vector<PixelSequence> sequences_;
  std::vector<std::uint32_t> pixels_;
  std::size_t latest_ = 0;
};

}  // namespace nocturne

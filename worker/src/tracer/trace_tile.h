// Walking photons and recording them, tile by tile: what a worker does for a job.
#pragma once

#include "scene/scene.h"
#include "tile/tile_sums.h"

namespace nocturne {

/// How a photon's path is followed; everything around it is shared.
enum class Method {
  kAdjointPhotons,
  /// Explicit direct light, for comparison only (tracer/baselines).
  kPathTracing,
};

/// Sums over the range's samples in sample order: a pure function of its arguments, bit for bit.
/// The range must lie in the film.
TileSums trace_tile(const Scene& scene, Film film, const TileRange& range,
                    Method method = Method::kAdjointPhotons);

}  // namespace nocturne

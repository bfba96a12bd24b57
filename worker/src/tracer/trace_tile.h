// Adjoint photons, tile by tile: what a worker does for most jobs.
#pragma once

#include "scene/scene.h"
#include "tile/tile_sums.h"
#include "tracer/batch.h"

namespace nocturne {

struct SkySightings;

/// What adjoint photons bring, sums over the range's samples in sample order: a pure function of
/// its arguments, bit for bit, and the same for any size of batches. The range must lie in the
/// film. What forward photons bring, where there are any, is in trace_photon_range.h. Throws
/// std::invalid_argument for scenes of these alone, TracingStopped within milliseconds after a stop
/// was requested. `sightings`: also keeps there where the photons met the sky, in the order of the
/// batches.
TileSums trace_tile(const Scene& scene, Film film, const TileRange& range,
                    std::uint32_t batch_groups = kBatchGroups, const std::stop_token& stop = {},
                    SkySightings* sightings = nullptr);

}  // namespace nocturne

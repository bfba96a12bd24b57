// Walking photons and recording them, tile by tile: what a worker does for a job.
#pragma once

#include "scene/scene.h"
#include "tile/tile_sums.h"
#include "tracer/batch.h"

namespace nocturne {

/// Sums over the range's samples in sample order: a pure function of its arguments, bit for bit,
/// and the same for any size of batches. The range must lie in the film. With both directions, a
/// tile that is less than the film has what its adjoint photons bring; see trace_photon_range.h for
/// the rest. Throws std::invalid_argument for forward photons of less than the film, TracingStopped
/// within milliseconds after a stop was requested.
TileSums trace_tile(const Scene& scene, Film film, const TileRange& range,
                    std::uint32_t batch_groups = kBatchGroups, const std::stop_token& stop = {});

/// The light that photons from one side alone bring: with both directions each a part of all light.
/// Those from luminaires need the whole film.
TileSums trace_from_sensor(const Scene& scene, Film film, const TileRange& range,
                           const std::stop_token& stop = {});
TileSums trace_from_luminaires(const Scene& scene, Film film, const TileRange& range,
                               const std::stop_token& stop = {});

}  // namespace nocturne

// Tiles by other methods than the tracer's, one sample after the other.
#pragma once

#include "scene/scene.h"
#include "tile/tile_sums.h"

namespace nocturne::baselines {

/// Path tracing. Throws std::invalid_argument where the scene has media.
TileSums trace_tile_by_paths(const Scene& scene, Film film, const TileRange& range);

/// Ray marching with at least one step on each piece of a ray.
TileSums trace_tile_by_marching(const Scene& scene, Film film, const TileRange& range,
                                std::uint32_t steps);

}  // namespace nocturne::baselines

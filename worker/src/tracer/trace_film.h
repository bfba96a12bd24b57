// A whole image on one machine, cut and merged exactly as the service does it.
#pragma once

#include <functional>
#include <span>

#include "tracer/trace_tile.h"

namespace nocturne {

/// The cuts of a render plan: square tiles row by row, and where each tile's sample ranges end
/// (increasing).
struct FilmPlan {
  Film film;
  std::uint32_t tile_size;
  std::span<const std::uint32_t> range_ends;
};

/// Sums of the film, row by row; photons, rays and invalid samples of all tiles. A tile's ranges
/// are added up in sample order, so the bits don't depend on the number of threads. `progress` is
/// told the share of photons traced, from any thread, one at a time. Throws what tracing a tile
/// throws.
TileSums trace_film(const Scene& scene, const FilmPlan& plan, Method method, unsigned threads,
                    const std::function<void(double)>& progress);

}  // namespace nocturne

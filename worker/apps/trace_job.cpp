#include "trace_job.h"

#include "tracer/trace_photon_range.h"
#include "tracer/trace_tile.h"

namespace nocturne {

DaylightTile trace_job(const Scene& scene, const std::optional<DaylightCoefficients>& daylight,
                       const v1::Job& job, const std::stop_token& stop) {
  const Film film{job.film_width(), job.film_height()};
  if (job.photons_by_tiles_of() > 0) {
    return {trace_photon_range(scene, film, job.photons_by_tiles_of(),
                               {job.first_sample(), job.end_sample()}, stop),
            {}};
  }
  const v1::Tile& tile = job.tile();
  const TileRange range{.x = tile.x(),
                        .y = tile.y(),
                        .width = tile.width(),
                        .height = tile.height(),
                        .first_sample = job.first_sample(),
                        .end_sample = job.end_sample()};
  if (daylight) return trace_daylight_tile(scene, *daylight, film, range, stop);
  return {trace_tile(scene, film, range, kBatchGroups, stop), {}};
}

}  // namespace nocturne

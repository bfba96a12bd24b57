#include "worker_loop/check_job.h"

#include <cstdint>
#include <string>

namespace nocturne {
namespace {

// The coordinator's bounds for a film (nocturne_coordinator/limits.py).
constexpr std::uint64_t kMaxFilmEdge = 16384;
constexpr std::uint64_t kMaxFilmPixels = std::uint64_t{1} << 26;
// 32 MiB of sums without further responses, far above the tiles of any plan; bounds what one job
// can make a worker allocate.
constexpr std::uint64_t kMaxTileEdge = 1024;
// A range of forward photons has the sums of the whole film, 1.2 GB of them.
constexpr std::uint64_t kMaxPhotonFilmPixels = std::uint64_t{1} << 24;
// The sample sequence has 2^31 indices.
constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 31;
constexpr std::size_t kDigestBytes = 32;
// Of a block of pixels (tile/tile_sums.h).
constexpr std::uint64_t kBlockEdge = 4;

void check_range(const std::string& field, std::uint64_t value, std::uint64_t lowest,
                 std::uint64_t highest) {
  if (value >= lowest && value <= highest) return;
  throw JobError("job." + field + " is " + std::to_string(value) + ", expected " +
                 std::to_string(lowest) + " ... " + std::to_string(highest));
}

// Its tile is the whole film, and blocks of pixels begin at the corners of tiles.
void check_photons(const v1::Job& job) {
  check_range("film_width x film_height", std::uint64_t{job.film_width()} * job.film_height(), 1,
              kMaxPhotonFilmPixels);
  check_range("tile.width", job.tile().width(), job.film_width(), job.film_width());
  check_range("tile.height", job.tile().height(), job.film_height(), job.film_height());
  const std::uint64_t edge = job.photons_by_tiles_of();
  check_range("photons_by_tiles_of", edge, kBlockEdge, kMaxTileEdge);
  check_range("photons_by_tiles_of % 4", edge % kBlockEdge, 0, 0);
}

}  // namespace

void check_job(const v1::Job& job) {
  if (job.scene().size() != kDigestBytes) {
    throw JobError("job.scene has " + std::to_string(job.scene().size()) +
                   " bytes, expected a SHA-256 of 32");
  }
  check_range("film_width", job.film_width(), 1, kMaxFilmEdge);
  check_range("film_height", job.film_height(), 1, kMaxFilmEdge);
  check_range("film_width x film_height", std::uint64_t{job.film_width()} * job.film_height(), 1,
              kMaxFilmPixels);
  const bool forward_photons = job.photons_by_tiles_of() > 0;
  const std::uint64_t most = forward_photons ? kMaxFilmEdge : kMaxTileEdge;
  const v1::Tile& tile = job.tile();
  check_range("tile.width", tile.width(), 1, most);
  check_range("tile.height", tile.height(), 1, most);
  check_range("tile.x + width", std::uint64_t{tile.x()} + tile.width(), 1, job.film_width());
  check_range("tile.y + height", std::uint64_t{tile.y()} + tile.height(), 1, job.film_height());
  if (forward_photons) check_photons(job);
  check_range("end_sample", job.end_sample(), 1, kMaxSamples);
  check_range("first_sample", job.first_sample(), 0, std::uint64_t{job.end_sample()} - 1);
}

}  // namespace nocturne

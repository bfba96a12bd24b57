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
// The sample sequence has 2^31 indices.
constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 31;
constexpr std::size_t kDigestBytes = 32;

void check_range(const std::string& field, std::uint64_t value, std::uint64_t lowest,
                 std::uint64_t highest) {
  if (value >= lowest && value <= highest) return;
  throw JobError("job." + field + " is " + std::to_string(value) + ", expected " +
                 std::to_string(lowest) + " ... " + std::to_string(highest));
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
  const v1::Tile& tile = job.tile();
  check_range("tile.width", tile.width(), 1, kMaxTileEdge);
  check_range("tile.height", tile.height(), 1, kMaxTileEdge);
  check_range("tile.x + width", std::uint64_t{tile.x()} + tile.width(), 1, job.film_width());
  check_range("tile.y + height", std::uint64_t{tile.y()} + tile.height(), 1, job.film_height());
  check_range("end_sample", job.end_sample(), 1, kMaxSamples);
  check_range("first_sample", job.first_sample(), 0, std::uint64_t{job.end_sample()} - 1);
}

}  // namespace nocturne

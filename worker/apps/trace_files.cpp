#include "trace_files.h"

#include <algorithm>
#include <ctime>
#include <functional>

namespace nocturne {

FilmPlan checked_schedule(const v1::RangeSchedule& schedule) {
  // The same bounds as the service's: 16384 pixels an edge, 2^26 in all.
  const auto pixels = static_cast<std::uint64_t>(schedule.width()) * schedule.height();
  // Blocks of pixels begin at a tile's corner.
  bool good = schedule.tile_size() % TileSums::kBlock == 0 && schedule.width() > 0 &&
              schedule.width() <= 16384 && schedule.height() > 0 && schedule.height() <= 16384 &&
              pixels <= (1u << 26) && schedule.tile_size() > 0 && schedule.tile_size() <= 16384 &&
              schedule.range_ends_size() + schedule.photon_range_ends_size() > 0;
  const auto increasing = [](const auto& ends) {
    return std::ranges::adjacent_find(ends, std::greater_equal()) == ends.end() &&
           (ends.empty() || ends[0] > 0);
  };
  good = good && increasing(schedule.range_ends()) && increasing(schedule.photon_range_ends());
  if (!good) throw std::runtime_error("the schedule's film, tiles or sample ranges make no sense");
  return {{schedule.width(), schedule.height()},
          schedule.tile_size(),
          {schedule.range_ends().data(), static_cast<std::size_t>(schedule.range_ends_size())},
          {schedule.photon_range_ends().data(),
           static_cast<std::size_t>(schedule.photon_range_ends_size())}};
}

FindBlob blobs_in(const std::string& folder) {
  return [folder](const std::string& sha256) {
    const auto path = std::filesystem::path(folder) / sha256.substr(0, 2) / sha256;
    if (!std::filesystem::is_regular_file(path))
      throw std::runtime_error("no file " + path.string());
    return path;
  };
}

void finish(std::ofstream& file, const std::string& path) {
  if (!file.flush()) throw std::runtime_error(path + ": can't be written");
}

void write_statistics(const std::string& path, const TileSums& image, double cpu_seconds,
                      double wall_seconds) {
  std::ofstream file(path);
  file.precision(17);
  file << "{\"photons\": " << image.photons << ", \"rays\": " << image.rays
       << ", \"invalid_samples\": " << image.invalid_samples
       << ", \"truncated_paths\": " << image.truncated_paths << ", \"cpu_seconds\": " << cpu_seconds
       << ", \"wall_seconds\": " << wall_seconds << "}\n";
  finish(file, path);
}

double process_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace nocturne

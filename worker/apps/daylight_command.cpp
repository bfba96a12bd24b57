#include "daylight_command.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "trace_files.h"
#include "tracer/trace_daylight.h"

namespace nocturne {
namespace {

Vec3 vector_of(const std::vector<float>& v) { return {v.at(0), v.at(1), v.at(2)}; }

std::vector<Vec3> read_suns(const std::string& path) {
  if (path.empty()) return {};
  std::vector<double> numbers(std::filesystem::file_size(path) / sizeof(double));
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(numbers.data()),
            static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  if (!file || numbers.size() % 3 != 0) {
    throw std::runtime_error(path + ": expected three numbers for each sun");
  }
  std::vector<Vec3> suns;
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    suns.push_back(
        normalized(Vec3{static_cast<float>(numbers[i]), static_cast<float>(numbers[i + 1]),
                        static_cast<float>(numbers[i + 2])}));
  }
  return suns;
}

}  // namespace

void run_daylight_command(const DaylightCommand& command, const v1::CompiledScene& message,
                          const v1::RangeSchedule& schedule,
                          const std::function<void(double)>& progress) {
  const FilmPlan plan = checked_schedule(schedule);
  if (plan.range_ends.empty() || plan.range_ends.back() <= command.first_sample) {
    throw std::runtime_error("no samples are left of the schedule");
  }
  const DaylightRequest request{
      plan.film,
      command.first_sample,
      plan.range_ends.back(),
      SkyPatches(command.divisions, vector_of(command.up), vector_of(command.north)),
      read_suns(command.suns),
      kSunRadius};
  const auto scene = load_scene(message, blobs_in(command.blobs));
  const double cpu_before = process_cpu_seconds();
  const auto wall_before = std::chrono::steady_clock::now();
  const DaylightSums sums = trace_daylight(*scene, request, command.threads, progress);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_before;
  std::ofstream file(command.output, std::ios::binary);
  for (const auto* part : {&sums.patches, &sums.suns, &sums.across}) {
    file.write(reinterpret_cast<const char*>(part->data()),
               static_cast<std::streamsize>(part->size() * sizeof(double)));
  }
  finish(file, command.output);
  if (command.statistics.empty()) return;
  TileSums counts(1, 1, 0);
  counts.photons = sums.photons;
  counts.rays = sums.rays;
  counts.invalid_samples = sums.invalid_samples;
  counts.truncated_paths = sums.truncated_paths;
  write_statistics(command.statistics, counts, process_cpu_seconds() - cpu_before, wall.count());
}

}  // namespace nocturne

// nocturne-baseline: images of compiled scenes by path tracing or ray marching, with the words of
// nocturne-trace, for tests and benches.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <mutex>
#include <thread>

#include "baselines/trace_tile.h"
#include "image/write_exr.h"
#include "trace_files.h"
#include "tracer/by_threads.h"

namespace nocturne {
namespace {

enum class Method { kPath, kMarch };

struct Options {
  std::string scene, schedule, blobs, output, statistics;
  Method method = Method::kPath;
  std::uint32_t steps = 64;
  bool quiet = false;
  unsigned threads = std::thread::hardware_concurrency();
};

TileSums trace(const Options& options, const Scene& scene, const FilmPlan& plan) {
  const auto [width, height] = plan.film;
  const std::uint32_t size = plan.tile_size, columns = (width + size - 1) / size;
  const std::size_t tiles = std::size_t{columns} * ((height + size - 1) / size);
  TileSums film(width, height, scene.wavelengths.further_curves(), tiles);
  std::mutex mutex;
  by_threads(tiles, options.threads, [&](std::size_t i) {
    const std::uint32_t x = static_cast<std::uint32_t>(i) % columns * size;
    const std::uint32_t y = static_cast<std::uint32_t>(i) / columns * size;
    const TileRange range{
        x, y, std::min(size, width - x), std::min(size, height - y), 0, plan.range_ends.back()};
    const TileSums tile =
        options.method == Method::kPath
            ? baselines::trace_tile_by_paths(scene, plan.film, range)
            : baselines::trace_tile_by_marching(scene, plan.film, range, options.steps);
    const std::lock_guard lock(mutex);
    add_tile(tile, range, i, film);
  });
  return film;
}

void run(const Options& options) {
  const auto schedule = read_message<v1::RangeSchedule>(options.schedule);
  const FilmPlan plan = checked_schedule(schedule);
  const auto scene =
      load_scene(read_message<v1::CompiledScene>(options.scene), blobs_in(options.blobs));
  const double cpu_before = process_cpu_seconds();
  const auto wall_before = std::chrono::steady_clock::now();
  const TileSums film = trace(options, *scene, plan);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_before;
  const double cpu = process_cpu_seconds() - cpu_before;
  const std::vector<std::string> responses(schedule.further_responses().begin(),
                                           schedule.further_responses().end());
  write_exr(options.output, film, plan.tile_size, responses, plan.range_ends.back(), {});
  if (!options.statistics.empty()) write_statistics(options.statistics, film, cpu, wall.count());
}

}  // namespace
}  // namespace nocturne

int main(int argc, char** argv) {
  nocturne::Options options;
  CLI::App app{"Images of compiled scenes by other methods than the tracer's, for comparison."};
  const std::map<std::string, nocturne::Method> methods{{"path", nocturne::Method::kPath},
                                                        {"march", nocturne::Method::kMarch}};
  app.add_option("scene", options.scene, "Compiled scene")->required()->check(CLI::ExistingFile);
  app.add_option("--schedule", options.schedule, "Range schedule")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--blobs", options.blobs, "Folder of meshes, textures and tables")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("-o,--output", options.output, "EXR to write")->required();
  app.add_option("--method", options.method, "path (path tracing) or march (ray marching)")
      ->required()
      ->transform(CLI::CheckedTransformer(methods));
  app.add_option("--steps", options.steps, "Of a ray marcher, on each piece of a ray (default 64)")
      ->check(CLI::Range(1, 1'000'000));
  app.add_option("--threads", options.threads, "Threads (default: all processors)")
      ->check(CLI::Range(1, 1024));
  app.add_option("--statistics", options.statistics, "JSON file for counts and times");
  app.add_flag("--quiet", options.quiet, "As of nocturne-trace; this program shows no progress");
  CLI11_PARSE(app, argc, argv);
  try {
    nocturne::run(options);
  } catch (const std::exception& error) {
    std::cerr << "nocturne-baseline: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

#include "job_tracer.h"

#include <time.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "assets/errors.h"
#include "digest/sha256.h"
#include "log/log.h"
#include "tracer/trace_tile.h"
#include "worker_loop/worker_options.h"

namespace nocturne {
namespace {

static_assert(std::endian::native == std::endian::little, "sums travel as little-endian float64");

double thread_cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

v1::Partial to_partial(const TileSums& tile, double cpu_seconds) {
  v1::Partial partial;
  for (const auto* values : {&tile.sums, &tile.block_squares, &tile.tile_squares}) {
    partial.mutable_sums()->append(reinterpret_cast<const char*>(values->data()),
                                   values->size() * sizeof(double));
  }
  partial.set_photons(tile.photons);
  partial.set_rays(tile.rays);
  partial.set_invalid_samples(tile.invalid_samples);
  partial.set_truncated_paths(tile.truncated_paths);
  partial.set_cpu_seconds(cpu_seconds);
  return partial;
}

TileRange to_range(const v1::Job& job) {
  return {.x = job.tile().x(),
          .y = job.tile().y(),
          .width = job.tile().width(),
          .height = job.tile().height(),
          .first_sample = job.first_sample(),
          .end_sample = job.end_sample()};
}

}  // namespace

std::shared_ptr<const Scene> JobTracer::load(const std::string& sha256) {
  std::ifstream file(assets_.find(sha256), std::ios::binary);
  v1::CompiledScene message;
  if (!message.ParseFromIstream(&file)) {
    throw std::runtime_error("scene " + sha256 + " is not a compiled scene");
  }
  auto scene = load_scene(message, [this](const std::string& blob) { return assets_.find(blob); });
  log_line(LogLevel::kInfo, "scene=" + sha256 + " loaded");
  return scene;
}

v1::Partial JobTracer::trace(const v1::Job& job, RunningJob& running) {
  std::shared_ptr<const Scene> scene;
  try {
    scene = scenes_.get(to_hex(job.scene()), [this](const std::string& key) { return load(key); });
  } catch (const AssetUnavailable& reason) {
    throw HandBack(reason.what());
  }
  running.begin_tracing();
  const double start = thread_cpu_seconds();
  const TileSums tile = trace_tile(*scene, Film{job.film_width(), job.film_height()}, to_range(job),
                                   Method::kAdjointPhotons, kBatchGroups, running.stop_token());
  return to_partial(tile, thread_cpu_seconds() - start);
}

}  // namespace nocturne

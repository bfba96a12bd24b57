#include "job_tracer.h"

#include <time.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <set>
#include <stdexcept>
#include <vector>

#include "assets/errors.h"
#include "digest/sha256.h"
#include "log/log.h"
#include "tile/photon_range.h"
#include "trace_job.h"
#include "worker_loop/worker_options.h"

namespace nocturne {
namespace {

static_assert(std::endian::native == std::endian::little, "sums travel as little-endian float64");

double thread_cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void append(const std::vector<double>& values, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
}

std::string sums_to_send(const v1::Job& job, const DaylightTile& tile) {
  if (job.photons_by_tiles_of() > 0) return encode_photon_sums(tile.sums);
  std::string bytes;
  for (const auto* values : tile.sums.numbers()) append(*values, bytes);
  append(tile.coefficients, bytes);
  return bytes;
}

v1::Partial to_partial(const v1::Job& job, const DaylightTile& found, double cpu_seconds) {
  const TileSums& tile = found.sums;
  v1::Partial partial;
  partial.set_sums(sums_to_send(job, found));
  partial.set_photons(tile.photons);
  partial.set_rays(tile.rays);
  partial.set_invalid_samples(tile.invalid_samples);
  partial.set_truncated_paths(tile.truncated_paths);
  partial.set_cpu_seconds(cpu_seconds);
  return partial;
}

/// Those of which something is read while photons are traced.
std::set<std::string> blobs_read_later(const v1::CompiledScene& message) {
  std::set<std::string> blobs;
  for (const auto& texture : message.textures()) blobs.insert(to_hex(texture.blob()));
  for (const auto& medium : message.media()) {
    blobs.insert(to_hex(medium.grid().blob()));
    blobs.insert(to_hex(medium.temperature().blob()));
  }
  return blobs;
}

std::shared_ptr<const LoadedScene> load(AssetCache& assets, const std::string& sha256,
                                        std::stop_token stop) {
  v1::CompiledScene message;
  {
    const auto file = assets.find(sha256);
    std::ifstream bytes(file->path(), std::ios::binary);
    if (!message.ParseFromIstream(&bytes)) {
      throw std::runtime_error("scene " + sha256 + " is not a compiled scene");
    }
  }
  const std::set<std::string> read_later = blobs_read_later(message);
  const auto loaded = std::make_shared<LoadedScene>();
  std::shared_ptr<const SealedFile> last;
  const auto find_blob = [&](const std::string& blob) {
    last = assets.find(blob);
    if (read_later.contains(blob)) loaded->files.push_back(last);
    return last->path();
  };
  const std::shared_ptr<Scene> scene = load_scene(message, find_blob, stop);
  loaded->daylight = load_daylight(message, *scene);
  loaded->scene = scene;
  log_line(LogLevel::kInfo, "scene=" + sha256 + " loaded");
  return loaded;
}

}  // namespace

JobTracer::JobTracer(AssetCache& assets, double max_load_seconds)
    : scenes_(kScenes, max_load_seconds,
              [&assets](const std::string& sha256, std::stop_token stop) {
                return load(assets, sha256, stop);
              }) {}

v1::Partial JobTracer::trace(const v1::Job& job, RunningJob& running) {
  std::shared_ptr<const LoadedScene> scene;
  try {
    scene = scenes_.get(to_hex(job.scene()), running.stop_token());
  } catch (const AssetUnavailable& reason) {
    throw HandBack(reason.what());
  }
  running.begin_tracing();
  const double start = thread_cpu_seconds();
  const DaylightTile sums = trace_job(*scene->scene, scene->daylight, job, running.stop_token());
  return to_partial(job, sums, thread_cpu_seconds() - start);
}

}  // namespace nocturne

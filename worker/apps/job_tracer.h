// From a job to its partial result: finds the scene, traces the tile.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assets/asset_cache.h"
#include "nocturne/v1/job.pb.h"
#include "scene/load_daylight.h"
#include "scene/load_scene.h"
#include "worker_loop/running_jobs.h"
#include "worker_loop/stoppable_loads.h"

namespace nocturne {

struct LoadedScene {
  /// Read while photons are traced.
  std::vector<std::shared_ptr<const SealedFile>> files;
  std::shared_ptr<const Scene> scene;
  std::optional<DaylightCoefficients> daylight;
};

/// For all threads; they share the scenes.
class JobTracer {
 public:
  /// `assets` must live as long as the process: a scene may be loading when this is gone.
  JobTracer(AssetCache& assets, double max_load_seconds);

  /// Throws HandBack if a file can't be had now, else what says why the job can't be done.
  v1::Partial trace(const v1::Job& job, RunningJob& running);

 private:
  // The coordinator takes turns between running renders, and a quick copy may be of a third; more
  // at a time load again.
  static constexpr std::size_t kScenes = 3;

  StoppableLoads<std::shared_ptr<const LoadedScene>> scenes_;
};

}  // namespace nocturne

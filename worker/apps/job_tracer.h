// From a job to its partial result: finds the scene, traces the tile.
#pragma once

#include <memory>
#include <string>

#include "assets/asset_cache.h"
#include "assets/load_once.h"
#include "nocturne/v1/job.pb.h"
#include "scene/load_scene.h"
#include "worker_loop/running_jobs.h"

namespace nocturne {

/// For all threads; they share the scenes.
class JobTracer {
 public:
  /// `assets` must outlive this.
  explicit JobTracer(AssetCache& assets) : assets_(assets), scenes_(kScenes) {}

  /// Throws HandBack if a file can't be had now, else what says why the job can't be done.
  v1::Partial trace(const v1::Job& job, RunningJob& running);

 private:
  // The coordinator takes turns between running renders; more than two at a time load again.
  static constexpr std::size_t kScenes = 2;

  std::shared_ptr<const Scene> load(const std::string& sha256);

  AssetCache& assets_;
  LoadOnce<std::shared_ptr<const Scene>> scenes_;
};

}  // namespace nocturne

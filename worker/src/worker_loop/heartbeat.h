// Tells Redis that this worker lives: its status every two seconds, the leases of its jobs every
// third of a lease. Stops jobs that nobody needs any more, and those that take too long.
#pragma once

#include <stop_token>

#include "queue/job_queue.h"
#include "worker_loop/running_jobs.h"
#include "worker_loop/tally.h"
#include "worker_loop/worker_options.h"

namespace nocturne {

class Heartbeat {
 public:
  /// All arguments must outlive this.
  Heartbeat(const WorkerOptions& options, RunningJobs& jobs, const Tally& tally);

  /// Returns when a stop is requested; withdraws the status then. Never throws.
  void run(std::stop_token stop);

 private:
  void beat();
  v1::WorkerStatus status() const;

  const WorkerOptions& options_;
  RunningJobs& jobs_;
  const Tally& tally_;
  JobQueue queue_;
  double started_;
  std::chrono::steady_clock::time_point next_status_;
  std::chrono::steady_clock::time_point next_extension_;
};

}  // namespace nocturne

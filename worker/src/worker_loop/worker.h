// A worker: threads that do jobs, and the heartbeat that keeps their leases.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "worker_loop/running_jobs.h"
#include "worker_loop/tally.h"
#include "worker_loop/worker_options.h"

namespace nocturne {

class Worker {
 public:
  /// Starts the threads.
  Worker(WorkerOptions options, TraceJob trace);

  /// Asks the threads to stop and waits for the jobs at hand, however long they take.
  ~Worker();

  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Takes no new jobs. Waits for the jobs at hand, at most `grace`, then stops tracing them, and
  /// gives them back; whether all threads have ended. They have not where a scene is being loaded.
  bool stop(std::chrono::milliseconds grace);

  /// Lets other workers have the jobs of threads that have not ended. Only right before the process
  /// ends: they still run.
  void hand_back();

 private:
  void run_thread(unsigned index, std::stop_token stop);

  const WorkerOptions options_;
  const TraceJob trace_;
  RunningJobs jobs_;
  Tally tally_;
  std::mutex mutex_;
  std::condition_variable thread_ended_;
  unsigned running_;
  // Last, so that they have ended before the rest is destroyed: first the threads, then the
  // heartbeat that keeps their leases.
  std::jthread heartbeat_;
  std::vector<std::jthread> threads_;
};

}  // namespace nocturne

// The jobs that the threads of a worker trace now, and what stops them before their end.
#pragma once

#include <time.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <stop_token>
#include <vector>

#include "queue/held_job.h"

namespace nocturne {

enum class StopReason {
  kNone,
  /// It took more processor time than any job of its plan should.
  kTooLong,
  /// Nobody needs its result any more.
  kWithdrawn,
  /// The worker ends.
  kShutdown,
};

class RunningJobs;

/// One job in the hands of the thread that made this, as long as this lives.
class RunningJob {
 public:
  RunningJob(RunningJobs& all, HeldJob held, double max_cpu_seconds);
  ~RunningJob();
  RunningJob(const RunningJob&) = delete;
  RunningJob& operator=(const RunningJob&) = delete;

  /// Processor time counts from here on; before, the scene is loaded. By the thread of the job.
  /// A quick copy must come here within seconds.
  void begin_tracing();

  /// For the tracer.
  std::stop_token stop_token() const { return stop_.get_token(); }
  /// Why it was asked to stop.
  StopReason stop_reason() const { return reason_; }

 private:
  friend class RunningJobs;

  void stop(StopReason reason);
  bool is_too_long() const;

  RunningJobs& all_;
  const HeldJob held_;
  const double max_cpu_seconds_;
  const std::chrono::steady_clock::time_point taken_ = std::chrono::steady_clock::now();
  clockid_t clock_{};
  // Of the thread's processor time; negative: not yet.
  std::atomic<double> begun_ = -1.0;
  std::stop_source stop_;
  std::atomic<StopReason> reason_ = StopReason::kNone;
};

/// For all threads.
class RunningJobs {
 public:
  std::vector<HeldJob> list() const;

  /// Stops those that took too much processor time.
  void stop_too_long();
  /// Stops these.
  void stop_withdrawn(const std::vector<HeldJob>& jobs);
  /// Stops all, now and from here on.
  void shut_down();

 private:
  friend class RunningJob;

  mutable std::mutex mutex_;
  std::vector<RunningJob*> jobs_;
  bool shut_down_ = false;
};

}  // namespace nocturne

// One thread's loop: take a job, trace it, complete it.
#pragma once

#include <optional>
#include <stop_token>

#include "queue/job_queue.h"
#include "worker_loop/back_off.h"
#include "worker_loop/running_jobs.h"
#include "worker_loop/tally.h"
#include "worker_loop/worker_options.h"

namespace nocturne {

class WorkerThread {
 public:
  /// All arguments must outlive this; `index` counts from 0 within the worker. Those from
  /// options.threads on take quick copies and nothing else.
  WorkerThread(const WorkerOptions& options, unsigned index, const TraceJob& trace,
               RunningJobs& jobs, Tally& tally);

  /// Returns after the job at hand when a stop is requested. Never throws: an operation that fails
  /// with Redis is tried again, an error of a job is reported as the job's failure.
  void run(std::stop_token stop);

 private:
  void step(std::stop_token stop);
  void work(const TakenJob& taken, std::stop_token stop);
  std::optional<v1::JobResult> result_of(const v1::Job& job, RunningJob& running);
  void deliver(const TakenJob& taken, const v1::JobResult& result, std::stop_token stop);
  void give_back(const TakenJob& taken);
  void report_trouble(const std::string& text);

  const WorkerOptions& options_;
  unsigned index_;
  // As it stands in logs.
  std::string name_;
  const TraceJob& trace_;
  RunningJobs& jobs_;
  Tally& tally_;
  JobQueue queue_;
  BackOff back_off_;
  // Repeated trouble is one line in the log.
  std::string last_trouble_;
};

}  // namespace nocturne

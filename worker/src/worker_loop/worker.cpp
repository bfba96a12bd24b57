#include "worker_loop/worker.h"

#include <sys/resource.h>

#include <utility>

#include "log/log.h"
#include "queue/job_queue.h"
#include "worker_loop/heartbeat.h"
#include "worker_loop/worker_thread.h"

namespace nocturne {
namespace {

// The tracer stops within milliseconds, and a job is given back in one call.
constexpr std::chrono::milliseconds kToStop{500};

/// Further threads for quick copies: short jobs of others than those whose long ones hold the rest.
/// Two, as one owner's copy may take a second, too.
constexpr unsigned kQuickThreads = 2;

/// Of the calling thread alone: in Linux each has its own.
void give_way(int nice) { setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + nice); }

}  // namespace

Worker::Worker(WorkerOptions options, TraceJob trace)
    : options_(std::move(options)),
      trace_(std::move(trace)),
      tally_(options_.threads + kQuickThreads),
      running_(options_.threads + kQuickThreads) {
  heartbeat_ =
      std::jthread([this](std::stop_token stop) { Heartbeat(options_, jobs_, tally_).run(stop); });
  for (unsigned index = 0; index < options_.threads + kQuickThreads; ++index) {
    threads_.emplace_back([this, index](std::stop_token stop) { run_thread(index, stop); });
  }
}

Worker::~Worker() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

void Worker::run_thread(unsigned index, std::stop_token stop) {
  if (index < options_.threads) give_way(options_.nice);
  WorkerThread(options_, index, trace_, jobs_, tally_).run(stop);
  {
    const std::lock_guard lock(mutex_);
    --running_;
  }
  thread_ended_.notify_all();
}

bool Worker::stop(std::chrono::milliseconds grace) {
  for (std::jthread& thread : threads_) thread.request_stop();
  std::unique_lock lock(mutex_);
  const auto all_ended = [this] { return running_ == 0; };
  if (thread_ended_.wait_for(lock, grace, all_ended)) return true;
  jobs_.shut_down();
  return thread_ended_.wait_for(lock, kToStop, all_ended);
}

void Worker::hand_back() {
  heartbeat_.request_stop();
  heartbeat_.join();
  try {
    JobQueue queue(options_.redis, options_.id, options_.lease);
    queue.hand_back(jobs_.list());
  } catch (const std::exception& error) {
    // The jobs' leases run out.
    log_line(LogLevel::kWarning,
             "worker=" + options_.id + " jobs not handed back: " + error.what());
  }
}

}  // namespace nocturne

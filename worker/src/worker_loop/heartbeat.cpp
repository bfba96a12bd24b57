#include "worker_loop/heartbeat.h"

#include <algorithm>
#include <chrono>
#include <fstream>

#include "log/log.h"
#include "queue/redis_errors.h"
#include "worker_loop/back_off.h"

namespace nocturne {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kStatusInterval{2000};

double unix_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

Heartbeat::Heartbeat(const WorkerOptions& options, RunningJobs& jobs, const Tally& tally)
    : options_(options),
      jobs_(jobs),
      tally_(tally),
      queue_(options.redis, options.id, options.lease),
      started_(unix_seconds()) {}

void Heartbeat::run(std::stop_token stop) {
  // Several times per interval, so that neither is late by much.
  const milliseconds tick = std::min(kStatusInterval, options_.lease / 3) / 4;
  while (!stop.stop_requested()) {
    try {
      beat();
    } catch (const std::exception& error) {
      // The threads report errors of Redis on standard error; the next tick tries again.
      log_line(LogLevel::kDebug, "worker=" + options_.id + " heartbeat: " + error.what());
      queue_.disconnect();
    }
    wait_unless_stopped(stop, tick);
  }
  try {
    queue_.withdraw_status(options_.id);
  } catch (const std::exception& error) {
    log_line(LogLevel::kDebug, "worker=" + options_.id + " status not withdrawn: " + error.what());
  }
}

void Heartbeat::beat() {
  jobs_.stop_too_long();
  const auto now = Clock::now();
  if (now >= next_extension_) {
    queue_.extend(jobs_.list());
    next_extension_ = now + options_.lease / 3;
  }
  if (now >= next_status_) {
    queue_.publish_status(status());
    if (!options_.alive.empty()) std::ofstream(options_.alive).flush();
    next_status_ = now + kStatusInterval;
  }
  jobs_.stop_withdrawn(queue_.withdrawn(jobs_.list()));
}

v1::WorkerStatus Heartbeat::status() const {
  v1::WorkerStatus status;
  status.set_worker_id(options_.id);
  status.set_engine(v1::ENGINE_CURRENT);
  status.set_floating_point_profile(options_.floating_point_profile);
  status.set_threads(options_.threads);
  status.set_started(started_);
  tally_.report(status);
  return status;
}

}  // namespace nocturne

#include "worker_loop/running_jobs.h"

#include <pthread.h>

#include <algorithm>

namespace nocturne {
namespace {

// For a quick copy to load its scene, else it is left to the other threads, which have time.
constexpr std::chrono::seconds kQuickLoad{2};

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

RunningJob::RunningJob(RunningJobs& all, HeldJob held, double max_cpu_seconds)
    : all_(all), held_(std::move(held)), max_cpu_seconds_(max_cpu_seconds) {
  pthread_getcpuclockid(pthread_self(), &clock_);
  const std::lock_guard lock(all_.mutex_);
  all_.jobs_.push_back(this);
  if (all_.shut_down_) stop(StopReason::kShutdown);
}

RunningJob::~RunningJob() {
  const std::lock_guard lock(all_.mutex_);
  std::erase(all_.jobs_, this);
}

void RunningJob::begin_tracing() { begun_ = seconds_of(clock_); }

void RunningJob::stop(StopReason reason) {
  if (reason_ != StopReason::kNone) return;
  reason_ = reason;
  stop_.request_stop();
}

bool RunningJob::is_too_long() const {
  const double begun = begun_;
  if (begun < 0.0 && held_.stream == keys::kQuickJobs) {
    return std::chrono::steady_clock::now() - taken_ > kQuickLoad;
  }
  return max_cpu_seconds_ > 0.0 && begun >= 0.0 && seconds_of(clock_) - begun > max_cpu_seconds_;
}

std::vector<HeldJob> RunningJobs::list() const {
  const std::lock_guard lock(mutex_);
  std::vector<HeldJob> held;
  for (const RunningJob* job : jobs_) held.push_back(job->held_);
  return held;
}

void RunningJobs::stop_too_long() {
  const std::lock_guard lock(mutex_);
  for (RunningJob* job : jobs_) {
    if (job->is_too_long()) job->stop(StopReason::kTooLong);
  }
}

void RunningJobs::stop_withdrawn(const std::vector<HeldJob>& jobs) {
  const std::lock_guard lock(mutex_);
  for (RunningJob* job : jobs_) {
    if (std::ranges::find(jobs, job->held_) != jobs.end()) job->stop(StopReason::kWithdrawn);
  }
}

void RunningJobs::shut_down() {
  const std::lock_guard lock(mutex_);
  shut_down_ = true;
  for (RunningJob* job : jobs_) job->stop(StopReason::kShutdown);
}

}  // namespace nocturne

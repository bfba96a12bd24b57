#include "queue/held_jobs.h"

#include <algorithm>

namespace nocturne {

HeldJobs::Hold::Hold(HeldJobs& all, HeldJob job) : all_(all), job_(std::move(job)) {
  const std::lock_guard lock(all_.mutex_);
  all_.jobs_.push_back(job_);
}

HeldJobs::Hold::~Hold() {
  const std::lock_guard lock(all_.mutex_);
  all_.jobs_.erase(std::find(all_.jobs_.begin(), all_.jobs_.end(), job_));
}

std::vector<HeldJob> HeldJobs::list() const {
  const std::lock_guard lock(mutex_);
  return jobs_;
}

}  // namespace nocturne

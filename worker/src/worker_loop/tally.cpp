#include "worker_loop/tally.h"

#include <numeric>

namespace nocturne {

void Tally::record(unsigned thread, const v1::Partial& partial, double seconds) {
  const std::lock_guard lock(mutex_);
  photons_ += partial.photons();
  rays_ += partial.rays();
  jobs_done_ += 1;
  photons_per_second_[thread] =
      seconds > 0 ? static_cast<double>(partial.photons()) / seconds : 0.0;
}

void Tally::rest(unsigned thread) {
  const std::lock_guard lock(mutex_);
  photons_per_second_[thread] = 0.0;
}

void Tally::report(v1::WorkerStatus& status) const {
  const std::lock_guard lock(mutex_);
  status.set_photons(photons_);
  status.set_rays(rays_);
  status.set_jobs_done(jobs_done_);
  status.set_photons_per_second(
      std::accumulate(photons_per_second_.begin(), photons_per_second_.end(), 0.0));
}

}  // namespace nocturne

// What the threads of this worker have done.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "nocturne/v1/job.pb.h"

namespace nocturne {

/// For all threads.
class Tally {
 public:
  explicit Tally(unsigned threads) : photons_per_second_(threads, 0.0) {}

  /// A job of `thread` is done; it took `seconds` of wall time.
  void record(unsigned thread, const v1::Partial& partial, double seconds);

  /// `thread` has nothing to do.
  void rest(unsigned thread);

  /// Fills photons, rays, jobs_done and photons_per_second: the sum of the rates of the threads'
  /// last jobs.
  void report(v1::WorkerStatus& status) const;

 private:
  mutable std::mutex mutex_;
  std::vector<double> photons_per_second_;
  std::uint64_t photons_ = 0;
  std::uint64_t rays_ = 0;
  std::uint64_t jobs_done_ = 0;
};

}  // namespace nocturne

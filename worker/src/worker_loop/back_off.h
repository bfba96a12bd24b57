// How long to wait before the next attempt: 0.1 s, doubling up to 2 s.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace nocturne {

/// Returns after `duration`, or as soon as a stop is requested.
inline void wait_unless_stopped(std::stop_token stop, std::chrono::milliseconds duration) {
  std::mutex mutex;
  std::condition_variable_any never_notified;
  std::unique_lock lock(mutex);
  never_notified.wait_for(lock, stop, duration, [] { return false; });
}

class BackOff {
 public:
  void wait(std::stop_token stop) {
    wait_unless_stopped(stop, next_);
    next_ = std::min(2 * next_, kLongest);
  }

  void reset() { next_ = kShortest; }

 private:
  static constexpr std::chrono::milliseconds kShortest{100};
  static constexpr std::chrono::milliseconds kLongest{2000};
  std::chrono::milliseconds next_ = kShortest;
};

}  // namespace nocturne

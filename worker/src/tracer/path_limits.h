// What ends a path before it is absorbed or out of the scene, and all tracing before its time.
#pragma once

#include <cstdint>
#include <exception>
#include <stop_token>
#include <utility>

namespace nocturne {

/// Thrown by the tracer soon after a stop was requested.
class TracingStopped : public std::exception {
 public:
  const char* what() const noexcept override { return "tracing was stopped"; }
};

/// The limits of one batch; counts the paths that it ends. A path that is ended misses light: the
/// image is biased.
class PathLimits {
 public:
  /// Rays of a path, and tentative collisions on one flight through a medium. A walk through a slab
  /// of optical thickness t takes some t^2 collisions, so that clouds of thickness 1000 are below
  /// it; the coordinator refuses results of more rays per photon (nocturne_coordinator/limits.py).
  static constexpr std::uint32_t kMaxRays = 1u << 20;
  static constexpr std::uint32_t kMaxTentative = 1u << 20;
  /// Tentative collisions between two looks whether to stop: some microseconds.
  static constexpr std::uint32_t kTentativeUnwatched = 1024;

  explicit PathLimits(std::stop_token stop) : stop_(std::move(stop)) {}

  /// Throws TracingStopped.
  void check_stop() const {
    if (stop_.stop_requested()) throw TracingStopped();
  }

  void begin() { truncated_ = 0; }
  void truncate(std::uint32_t paths) { truncated_ += paths; }
  /// Paths ended since begin().
  std::uint64_t truncated() const { return truncated_; }

 private:
  std::stop_token stop_;
  std::uint64_t truncated_ = 0;
};

}  // namespace nocturne

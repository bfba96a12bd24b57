#pragma once

#include <cstdint>

namespace nocturne::baselines {

struct PathResult {
  /// An estimate of spectral radiance, W m-2 sr-1 nm-1.
  float radiance;
  std::uint32_t rays;
};

}  // namespace nocturne::baselines

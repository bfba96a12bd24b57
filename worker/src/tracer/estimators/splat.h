#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "spectrum/spectral.h"

namespace nocturne {

/// What one group of forward photons adds to a pixel.
template <int N>
struct Splat {
  /// Of the batch.
  std::uint32_t sample;
  std::uint32_t pixel;
  /// Of each photon: an estimate of the spectral quantity that the pixel measures.
  Spectral<N> value;
  /// See meets_direct_light.
  bool direct;
  /// Of what emitted it.
  std::uint32_t light_group;
};

/// In the order of the samples; those of one sample as they were counted.
template <int N>
void sort_by_sample(std::vector<Splat<N>>& splats) {
  std::stable_sort(splats.begin(), splats.end(),
                   [](const Splat<N>& a, const Splat<N>& b) { return a.sample < b.sample; });
}

}  // namespace nocturne

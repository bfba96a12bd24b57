// A unit of work, and what it yields: sums and counts, never averages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace nocturne {

/// Samples [first_sample, end_sample) of a rectangle of pixels; x to the right, y down.
struct TileRange {
  std::uint32_t x, y, width, height;
  std::uint32_t first_sample, end_sample;
};

/// Float64: single precision stops counting at 2^24 samples.
struct TileSums {
  /// Sum X, sum Y, sum Z, sum Y^2; then a sum for each further response of the sensor.
  static constexpr std::size_t kXyzChannels = 4;

  /// At least kXyzChannels.
  std::size_t channels;
  /// Channels of each pixel side by side, row by row.
  std::vector<double> sums;
  std::uint64_t photons = 0;
  std::uint64_t rays = 0;
  /// Photons left out because their contribution was negative or not finite.
  std::uint64_t invalid_samples = 0;
  /// Photons ended by a limit of the tracer that is no property of the scene: bias.
  std::uint64_t truncated_paths = 0;

  explicit TileSums(std::size_t pixels = 0, std::size_t further_responses = 0)
      : channels(kXyzChannels + further_responses), sums(channels * pixels) {}
};

}  // namespace nocturne

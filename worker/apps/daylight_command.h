// nocturne-trace --daylight.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "nocturne/v1/job.pb.h"
#include "nocturne/v1/scene.pb.h"

namespace nocturne {

struct DaylightCommand {
  /// Of each of Tregenza's patches along an edge; 0: no daylight is asked for.
  std::uint32_t divisions = 0;
  std::vector<float> up{0, 1, 0}, north{0, 0, -1};
  std::uint32_t first_sample = 0;
  /// File of directions towards suns as float64, or empty.
  std::string suns;
  std::string blobs, output, statistics;
  unsigned threads = 1;
};

/// Samples up to the schedule's end. Writes float64, row by row of pixels: sums by patch of what
/// comes straight and of all else; then by pixel and sun; then across suns by pixel: see
/// DaylightSums.
void run_daylight_command(const DaylightCommand& command, const v1::CompiledScene& message,
                          const v1::RangeSchedule& schedule,
                          const std::function<void(double)>& progress);

}  // namespace nocturne

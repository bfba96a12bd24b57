// nocturne-trace --pilot: which method of tracing a scene is best, for whoever compiles it
// (docs/decisions/0062-ways-are-chosen-by-a-pilot.md).
#pragma once

#include <string>
#include <vector>

#include "nocturne/v1/job.pb.h"
#include "nocturne/v1/scene.pb.h"

namespace nocturne {

struct PilotCommand {
  /// The methods that may be chosen: names of kPilotChooses.
  std::vector<std::string> open;
  std::string blobs, output;
  unsigned threads;
};

inline const std::vector<std::string> kPilotChooses{"direction", "aim",   "learn",   "ratio",
                                                    "guide",     "parts", "sharing", "sky"};

/// A JSON file: the best method, and the figures of each. Throws like loading and tracing.
void run_pilot_command(const PilotCommand& command, v1::CompiledScene message,
                       const v1::RangeSchedule& schedule);

}  // namespace nocturne

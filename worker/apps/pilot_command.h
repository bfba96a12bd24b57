// nocturne-trace --pilot: which way to trace a scene is best, for whoever compiles it
// (docs/decisions/0062-ways-are-chosen-by-a-pilot.md).
#pragma once

#include <string>
#include <vector>

#include "nocturne/v1/job.pb.h"
#include "nocturne/v1/scene.pb.h"

namespace nocturne {

struct PilotCommand {
  /// What may be chosen: names of kPilotChooses.
  std::vector<std::string> open;
  std::string blobs, output;
  unsigned threads;
};

inline const std::vector<std::string> kPilotChooses{"direction", "aim",   "learn",  "ratio",
                                                    "guide",     "parts", "sharing"};

/// A JSON file: what is best, and what each way did. Throws what loading and tracing throw.
void run_pilot_command(const PilotCommand& command, v1::CompiledScene message,
                       const v1::RangeSchedule& schedule);

}  // namespace nocturne

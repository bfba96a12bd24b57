// How much a pilot may take: a small part of the render that it is for.
#pragma once

#include "tracer/pilot/pilot.h"
#include "tracer/pilot/trials.h"

namespace nocturne {

struct PilotBudget {
  /// Samples in all.
  double samples = 0.0;
  /// Y of the image, cd/m2, by the few samples whose rays were counted.
  double mean = 0.0;
};

/// Part of its samples with which a pilot tries sharing.
constexpr double kForSharing = 1.0 / 3;

PilotBudget pilot_budget(Trials& trials, const PilotRequest& request);

}  // namespace nocturne

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

/// Throws std::runtime_error where half of a few samples take more rays than 2^14: what a pilot
/// traces would then take minutes, and whether it came to its end would be the machine's to say.
void check_that_samples_end(Scene& scene, Film film, unsigned threads);

PilotBudget pilot_budget(Trials& trials, const PilotRequest& request);

}  // namespace nocturne

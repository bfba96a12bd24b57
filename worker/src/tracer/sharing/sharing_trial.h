// What sharing between neighbours is worth, by some squares of the film that is to be rendered:
// neighbours must be as near as they will be (docs/decisions/0062 and 0115).
#pragma once

#include "tracer/pilot/compare_methods.h"
#include "tracer/pilot/trials.h"

namespace nocturne {

struct SharingTrial {
  PilotFigures alone, shared;
  /// The mean of those that share over that of the others less 1, where it differs beyond chance: a
  /// fault, as both show the same light. Else 0.
  double differs_by = 0.0;
};

/// `kind`: photons from the sensor of pixels alone. `budget`: samples in all that may be taken.
SharingTrial try_sharing(Trials& trials, Film film, const PhotonKind& kind, double budget);

/// `method`, whose photons from the sensor were tried alone, with those that share.
MethodFigures with_sharing(const MethodFigures& method, const SharingTrial& trial,
                           bool ratio_is_open);

}  // namespace nocturne

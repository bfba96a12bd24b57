// Targets that photons from luminaires should be aimed at, by places that were worth reaching
// (docs/decisions/0081-learned-aims.md).
#pragma once

#include <vector>

#include "math/vec3.h"

namespace nocturne {

/// A ball that photons are worth being sent to.
struct Aim {
  Vec3 centre;
  float radius;
  /// Relative to the others, positive.
  double weight;
};

/// At most 16 balls around most of the places that were worth it; none where these are too few to
/// tell. Depends on the order of the places by rounding only.
std::vector<Aim> aims_around(const std::vector<Vec3>& places);

}  // namespace nocturne

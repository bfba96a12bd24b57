// Learns from some photons of the sensor which part of the sky is visible from where
// (docs/decisions/0116-visible-sky.md).
#pragma once

#include <cstdint>
#include <vector>

#include "luminaires/visible_sky.h"
#include "scene/scene.h"

namespace nocturne {

struct LearnedSky {
  /// At most VisibleSky::kMaxSightings, spread over all; none where most directions to the sky are
  /// free, so that there is nothing to learn.
  std::vector<VisibleSky::Sighting> sightings;
  /// Of pixels, that were traced.
  std::uint64_t samples = 0;
};

/// From about so many samples of pixels, in lines over all of the film. The same on any number of
/// threads. Random numbers are others than those of a render. `scene` is as before at the end.
LearnedSky learn_visible_sky(Scene& scene, Film film, double samples, unsigned threads);

}  // namespace nocturne

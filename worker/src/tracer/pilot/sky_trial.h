// The gain by a learned visible sky for photons from the sensor.
#pragma once

#include <cstdint>

#include "luminaires/visible_sky.h"
#include "scene/scene.h"
#include "tracer/trace_tile.h"

namespace nocturne {

struct SkyTrial {
  bool pays = false;
  /// Of pixels, that were traced.
  std::uint64_t samples = 0;
};

/// Whether adjoint photons have less error for the same cost where half of those towards the sky go
/// to the learned part of it: the environment's own density has these, too, and may know better
/// where a window shows the Sun (docs/decisions/0116-visible-sky.md). It pays if it does by more
/// than a standard error, by about so many samples of a small film. `scene` knows `sky` afterwards
/// if that pays, and nothing otherwise.
SkyTrial try_visible_sky(Scene& scene, VisibleSky sky, Film film, double samples, unsigned threads);

}  // namespace nocturne

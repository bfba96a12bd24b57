// Ray marching through media with explicit direct light, for comparison only: Morley et al. 2006,
// figures 6 to 8, hold adjoint photons against it. It takes `steps` equal steps through every piece
// of medium on a ray, and at each of them as many towards a light, so that its cost grows with
// their square; it is biased by the steps' length, and knows light that was scattered once.
#pragma once

#include "baselines/path_result.h"
#include "scene/scene.h"
#include "tracer/group.h"

namespace nocturne::baselines {

/// Surfaces end a ray; only matched boundaries are passed. Nothing is seen in media that end
/// nowhere.
PathResult march_ray(const Scene& scene, const Start<1>& start, const PhotonSequence& sequence,
                     std::uint32_t steps);

}  // namespace nocturne::baselines

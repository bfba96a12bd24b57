// Path tracing with explicit direct light, for comparison only. Kajiya, SIGGRAPH 1986; weights of
// both techniques towards a light by the power heuristic, Veach and Guibas, SIGGRAPH 1995. It
// shares nothing with the tracing loop, so that each can be held against the other.
#pragma once

#include "baselines/path_result.h"
#include "scene/scene.h"
#include "tracer/group.h"

namespace nocturne::baselines {

/// A shadow ray ends at the first surface, so light behind glass is found by the kernel alone.
/// Bodies of glass must not overlap.
PathResult trace_path(const Scene& scene, const Start<1>& start, const PhotonSequence& sequence);

}  // namespace nocturne::baselines

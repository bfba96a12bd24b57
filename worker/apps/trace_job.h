// A job's sums, by the message that describes it.
#pragma once

#include <stop_token>

#include "nocturne/v1/job.pb.h"
#include "scene/scene.h"
#include "tile/tile_sums.h"

namespace nocturne {

/// Of a tile's samples, or of a range of forward photons. The job must be a checked one; throws
/// what tracing throws.
TileSums trace_job(const Scene& scene, const v1::Job& job, const std::stop_token& stop = {});

}  // namespace nocturne

// A job's sums, by the message that describes it.
#pragma once

#include <optional>
#include <stop_token>

#include "nocturne/v1/job.pb.h"
#include "scene/scene.h"
#include "tracer/trace_daylight.h"

namespace nocturne {

/// Of a tile's samples, or of a range of forward photons; with daylight coefficients, if there are
/// any. The job must be a checked one; throws what tracing throws.
DaylightTile trace_job(const Scene& scene, const std::optional<DaylightCoefficients>& daylight,
                       const v1::Job& job, const std::stop_token& stop = {});

}  // namespace nocturne

// The tracing loop, for both directions: from the sensor to the luminaires, counting light, and
// from the luminaires to the sensor, counting the sensors that meet it. Morley et al., "Image
// Synthesis using Adjoint Photons", GI 2006, sections 2 to 4; in stages over a batch of photons:
// Laine, Karras and Aila, "Megakernels Considered Harmful", HPG 2013; docs/decisions/0038.
//
// Photons of one group share their numbers, and so every decision that does not depend on the
// wavelength; where one differs they part and go on as separate groups. The outcome of a group does
// not depend on the others of its batch.
#pragma once

#include "tracer/stages/connect.h"
#include "tracer/stages/count.h"
#include "tracer/stages/fly.h"
#include "tracer/stages/intersect.h"
#include "tracer/stages/scatter.h"
#include "tracer/stages/start.h"

namespace nocturne {

/// Follows all groups of a batch until they are absorbed, out of the scene, or at the limit of
/// rays. Throws TracingStopped.
template <int N, class Estimator, bool Media>
void trace_batch(Batch<N, Estimator, Media>& batch) {
  for (std::uint32_t rays = 0; !batch.groups.empty(); ++rays) {
    batch.limits.check_stop();
    if (rays == PathLimits::kMaxRays) return batch.truncate();
    intersect(batch);                 // the nearest surface
    if constexpr (Media) fly(batch);  // media before it: which are met, what passes
    count(batch);                     // light that is met, with its MIS weight
    scatter(batch);                   // kernels: next event estimation, roulette, directions
    connect(batch);                   // to lights and to the camera, where the way is free
    batch.groups.swap(batch.next);
    batch.next.clear();
  }
}

}  // namespace nocturne

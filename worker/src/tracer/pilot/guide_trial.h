// What a guide is worth to photons from the sensor, by the light that it is made for.
#pragma once

#include <vector>

#include "tracer/pilot/trials.h"

namespace nocturne {

/// A guide helps photons from the sensor to what mirrors and glass gather and no photon from a
/// luminaire brings, and costs time everywhere else. That light alone decides: whether more of it
/// is met, or it is found more often, or with less variance. Errors of a few images don't show
/// what hardly any photon finds. Of `methods`, the plainest of which is the first, those with a
/// guide are erased, or those that the guide makes better.
/// `samples`: of each pixel of the render; `mean`: Y of the image, cd/m2. Returns zero, or the part
/// by which guided photons brought less of that light than others, beyond chance: a fault of the
/// program.
double choose_guide(Scene& scene, Trials& trials, std::vector<PilotMethod>& methods, Film film,
                    std::uint32_t samples, double mean);

}  // namespace nocturne

// A path tracer with explicit direct light, kept for comparison: a second method for the same
// answer. Cook-style shadow rays to one luminaire point at every vertex, kernel sampling for the
// rest, luminaires met by chance counted for the sensor's ray only. Kajiya, "The Rendering
// Equation", SIGGRAPH 1986.
#pragma once

#include "tracer/trace_photon.h"

namespace nocturne::baselines {

/// Same meaning as trace_photon; mixture weights are not used.
PhotonResult trace_path(const Scene& scene, Ray ray, float wavelength_nm, PhotonSequence& sequence);

}  // namespace nocturne::baselines

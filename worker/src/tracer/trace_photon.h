// The adjoint tracing loop. Morley et al., "Image Synthesis using Adjoint Photons", GI 2006,
// section 3.
#pragma once

#include <cstdint>

#include "math/ray.h"
#include "sampling/sequence.h"
#include "scene/scene.h"

namespace nocturne {

struct PhotonResult {
  /// What the photon found on luminaires: an estimate of spectral radiance at its wavelength, W m-2
  /// sr-1 nm-1.
  float radiance;
  std::uint32_t rays;
};

/// Follows one photon of one wavelength from the sensor until it is absorbed or leaves the scene.
PhotonResult trace_photon(const Scene& scene, Ray ray, float wavelength_nm,
                          PhotonSequence& sequence);

}  // namespace nocturne

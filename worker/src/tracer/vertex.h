// What every method asks first where a photon meets a surface.
#pragma once

#include "math/frame.h"
#include "scene/scene.h"

namespace nocturne {

/// Radiance that the surface itself sends to where the photon came from; 0 where it is no
/// luminaire.
inline float emitted(const Scene& scene, const Hit& hit, Vec3 towards, float wavelength_nm) {
  const std::uint32_t luminaire = scene.materials[hit.surface].luminaire;
  if (luminaire == SurfaceMaterial::kNoLuminaire) return 0.0f;
  return scene.luminaires[luminaire].emitted(hit.normal, towards, wavelength_nm);
}

/// The kernel's frame: its normal on the side that the photon came from.
inline Frame facing_frame(const Hit& hit, Vec3 incoming) {
  return Frame(dot(hit.normal, incoming) > 0.0f ? -hit.normal : hit.normal);
}

}  // namespace nocturne

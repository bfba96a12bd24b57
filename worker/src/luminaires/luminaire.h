// A surface that emits: spectral radiance, W m-2 sr-1 nm-1, the same in all directions of the
// emitting side(s).
#pragma once

#include <cstdint>

#include "math/vec3.h"
#include "spectrum/spectrum.h"

namespace nocturne {

struct Luminaire {
  /// Index of the surface that emits.
  std::uint32_t surface;
  Spectrum radiance;
  bool two_sided;

  /// Radiance towards `direction` (away from the surface) at a point with that normal.
  float emitted(Vec3 normal, Vec3 direction, float wavelength_nm) const {
    if (!two_sided && dot(normal, direction) <= 0.0f) return 0.0f;
    return radiance(wavelength_nm);
  }
};

}  // namespace nocturne

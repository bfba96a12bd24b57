// Lambert's law: BRDF reflectance/pi from both sides. Lambert, Photometria, 1760.
#pragma once

#include "kernels/kernel.h"
#include "spectrum/spectrum.h"

namespace nocturne {

struct BoundLambertian {
  float reflectance;

  float albedo(Vec3) const { return reflectance; }
  float value(Vec3, Vec3 wi) const { return reflectance * CosineHemisphere::pdf(wi); }
  static std::optional<Vec3> sample(Vec3, float u1, float u2) {
    return CosineHemisphere::sample(u1, u2);
  }
  static float pdf(Vec3, Vec3 wi) { return CosineHemisphere::pdf(wi); }
};
static_assert(BoundKernel<BoundLambertian>);

/// Reflectance in [0, 1].
struct Lambertian {
  Spectrum reflectance;

  BoundLambertian bind(float wavelength_nm) const { return {reflectance(wavelength_nm)}; }
};

}  // namespace nocturne

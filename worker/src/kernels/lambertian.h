// Lambert's law: BRDF reflectance/pi from both sides. Lambert, Photometria, 1760.
#pragma once

#include "kernels/kernel.h"
#include "parameters/colour.h"

namespace nocturne {

template <int N>
struct BoundLambertian : UniformSampling<N> {
  Spectral<N> reflectance;

  explicit BoundLambertian(const Spectral<N>& r) : reflectance(r) {}

  Spectral<N> albedo(Vec3) const { return reflectance; }
  Spectral<N> value(Vec3, Vec3 wi) const { return CosineHemisphere::pdf(wi) * reflectance; }
  static std::optional<Draw<N>> sample(Vec3, const KernelNumbers& numbers, std::size_t) {
    return Draw<N>{.wi = CosineHemisphere::sample(numbers.u, numbers.v)};
  }
  static Spectral<N> pdf(Vec3, Vec3 wi) { return CosineHemisphere::pdf(wi); }
};
static_assert(BoundKernel<BoundLambertian<1>, 1> && BoundKernel<BoundLambertian<4>, 4>);

/// Reflectance in [0, 1].
struct Lambertian {
  Colour reflectance;

  static constexpr bool has_delta_lobe() { return false; }
  static constexpr bool may_transmit() { return false; }

  template <int N>
  BoundLambertian<N> bind(const Shading<N>& shading) const {
    return BoundLambertian<N>(reflectance(shading.point, shading.wavelengths));
  }
};

}  // namespace nocturne

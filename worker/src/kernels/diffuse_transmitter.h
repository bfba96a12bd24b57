// Lambert's law on both sides: reflectance/pi to the side that light comes from, transmittance/pi
// to the other. A thin sheet such as paper or a leaf.
#pragma once

#include <algorithm>
#include <utility>

#include "kernels/kernel.h"
#include "parameters/colour.h"

namespace nocturne {

template <int N>
struct BoundDiffuseTransmitter {
  Spectral<N> reflectance, transmittance;
  /// Probability that sample reflects; the same for all wavelengths.
  float reflecting;

  Spectral<N> albedo(Vec3) const { return reflectance + transmittance; }
  Spectral<N> value(Vec3, Vec3 wi) const {
    return std::fabs(wi.z) * kInvPi * (wi.z > 0.0f ? reflectance : transmittance);
  }
  std::optional<Draw<N>> sample(Vec3, const KernelNumbers& numbers, std::size_t) const {
    Vec3 wi = CosineHemisphere::sample(numbers.u, numbers.v);
    if (!(numbers.part < reflecting)) wi.z = -wi.z;
    return Draw<N>{.wi = wi};
  }
  Spectral<N> pdf(Vec3, Vec3 wi) const {
    return std::fabs(wi.z) * kInvPi * (wi.z > 0.0f ? reflecting : 1.0f - reflecting);
  }
  static constexpr bool smooth() { return true; }
  static constexpr bool transmits() { return true; }
};
static_assert(BoundKernel<BoundDiffuseTransmitter<1>, 1> &&
              BoundKernel<BoundDiffuseTransmitter<4>, 4>);

class DiffuseTransmitter {
 public:
  /// Sum at most 1 at every wavelength.
  DiffuseTransmitter(Colour reflectance, Colour transmittance)
      : reflectance_(std::move(reflectance)), transmittance_(std::move(transmittance)) {
    const float r = reflectance_.mean(), t = transmittance_.mean();
    if (r > 0.0f || t > 0.0f) reflecting_ = r / (r + t);
  }

  static constexpr bool has_delta_lobe() { return false; }
  static constexpr bool may_transmit() { return true; }

  template <int N>
  BoundDiffuseTransmitter<N> bind(const Shading<N>& shading) const {
    return {reflectance_(shading.point, shading.wavelengths),
            transmittance_(shading.point, shading.wavelengths), reflecting_};
  }

 private:
  Colour reflectance_, transmittance_;
  float reflecting_ = 0.5f;
};

}  // namespace nocturne

// Lets everything through unchanged, as if the surface weren't there: the clear part of an opacity
// mask.
#pragma once

#include "kernels/mueller.h"

namespace nocturne {

template <int N>
struct BoundNullKernel {
  static Spectral<N> albedo(Vec3) { return 1.0f; }
  static Spectral<N> value(Vec3, Vec3) { return 0.0f; }
  static std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers&, std::size_t) {
    return Draw<N>{.wi = -wo, .delta = true};
  }
  static Spectral<N> pdf(Vec3, Vec3) { return 0.0f; }
  static Mueller<N> mueller(Vec3, Vec3, std::uint32_t) { return Mueller<N>::unchanged(); }
  static constexpr bool smooth() { return false; }
  static constexpr bool transmits() { return false; }
};
static_assert(BoundKernel<BoundNullKernel<1>, 1> && BoundKernel<BoundNullKernel<4>, 4>);

struct NullKernel {
  static constexpr bool has_delta_lobe() { return true; }
  static constexpr bool may_transmit() { return true; }

  template <int N>
  BoundNullKernel<N> bind(const Shading<N>&) const {
    return {};
  }
};

}  // namespace nocturne

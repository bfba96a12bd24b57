// A thin sheet that polarises or retards: light goes straight on, the field along its axis weakened
// by one number and the field across it by another, and behind in phase. Malus's law; a
// quarter-wave plate where the retardance is pi / 2.
#pragma once

#include "kernels/mueller.h"
#include "math/functions.h"

namespace nocturne {

template <int N>
struct BoundPolarisingFilter {
  /// Shares of the power; radians.
  Spectral<N> along, across, retardance;
  /// In the scene, unit length.
  Vec3 axis;

  /// Of unpolarised light.
  Spectral<N> through() const { return 0.5f * (along + across); }

  Spectral<N> albedo(Vec3) const { return through(); }
  static Spectral<N> value(Vec3, Vec3) { return 0.0f; }
  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers&, std::size_t) const {
    return Draw<N>{.wi = -wo, .delta = true, .factor = through()};
  }
  static Spectral<N> pdf(Vec3, Vec3) { return 0.0f; }
  static constexpr bool smooth() { return false; }
  static constexpr bool transmits() { return false; }

  Mueller<N> mueller(Vec3, Vec3, std::uint32_t) const {
    Mueller<N> found;
    for (std::size_t i = 0; i < N; ++i) {
      const double phase = retardance[i], size = std::sqrt(static_cast<double>(across[i]));
      found.set(i, {std::sqrt(static_cast<double>(along[i]))},
                {size * math::cos(phase), size * math::sin(phase)});
    }
    return found;
  }
};
static_assert(BoundKernel<BoundPolarisingFilter<1>, 1> && BoundKernel<BoundPolarisingFilter<4>, 4>);
static_assert(Polarises<BoundPolarisingFilter<4>, 4>);

struct PolarisingFilter {
  /// In [0, 1]; and the phase, in radians, by which the field across is behind.
  Spectrum along, across, retardance;
  Vec3 axis;

  static constexpr bool has_delta_lobe() { return true; }
  static constexpr bool may_transmit() { return true; }

  template <int N>
  BoundPolarisingFilter<N> bind(const Shading<N>& shading) const {
    const Spectral<N>& nm = shading.wavelengths;
    return {along(nm), across(nm), retardance(nm), axis};
  }
};

}  // namespace nocturne

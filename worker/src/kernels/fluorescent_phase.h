// How a medium with dyes in it scatters. Besides what its particles scatter, a dye absorbs light of
// some wavelengths and sends it on at others, in all directions alike: along a ray comes, per
// metre,
//   emission(out) x integral of absorption(in) in L(in) d(in),
// L(in) as a mean over directions, absorption in 1/m, emission as in fluorescent.h. Where a dye
// emits it may be clear, so that photons from the sensor would pass and never meet it. So they
// collide more often than light does (Medium::collisions), and some collisions are null: the photon
// passes straight on. E. R. Woodcock et al., "Techniques used in the GEM code for Monte Carlo
// neutronics calculations", ANL-7050, 1965.
#pragma once

#include <optional>
#include <utility>

#include "kernels/fluorescent.h"
#include "kernels/phase.h"

namespace nocturne {

/// A photon met a particle that scatters it, or nothing.
template <int N>
struct BoundFluorescentPhase {
  BoundPhase<N> phase;
  bool passes = false;

  Spectral<N> albedo(Vec3 wo) const { return passes ? Spectral<N>(1.0f) : phase.albedo(wo); }
  Spectral<N> value(Vec3 wo, Vec3 wi) const {
    return passes ? Spectral<N>(0.0f) : phase.value(wo, wi);
  }
  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t lead) const {
    if (passes) return Draw<N>{.wi = -wo, .delta = true};
    return phase.sample(wo, numbers, lead);
  }
  Spectral<N> pdf(Vec3 wo, Vec3 wi) const { return passes ? Spectral<N>(0.0f) : phase.pdf(wo, wi); }
  Spectral<N> likelihood(Vec3 wo, Vec3 wi) const {
    return passes ? Spectral<N>(1.0f) : phase.likelihood(wo, wi);
  }
  bool smooth() const { return !passes; }
  static constexpr bool transmits() { return true; }

  Mueller<N> mueller(Vec3 wo, Vec3 wi, std::uint32_t photons) const {
    return passes ? Mueller<N>::unchanged() : phase.mueller(wo, wi, photons);
  }
};
static_assert(BoundKernel<BoundFluorescentPhase<1>, 1> && BoundKernel<BoundFluorescentPhase<4>, 4>);

struct FluorescentPhase {
  Phase phase;
  /// Absorption in 1/m at density 1.
  Fluorophores fluorophores;
  /// Besides those of light, 1/m at density 1.
  Spectrum null_collisions;

  static constexpr bool has_delta_lobe() { return true; }
  static constexpr bool may_transmit() { return false; }

  /// Of all collisions, for each photon: those with particles that scatter and null ones. And, in
  /// 1/m at density 1, how many collisions there are, and what dyes would emit if light had the
  /// same power at all wavelengths.
  template <int N>
  struct Parts {
    Spectral<N> scattered, passed, collisions, emitted;
  };
  template <int N>
  Parts<N> parts(const Spectral<N>& wavelengths) const {
    const Spectral<N> scattering = phase.scattering(wavelengths),
                      none = null_collisions(wavelengths),
                      all = phase.absorption(wavelengths) + scattering + none;
    const auto over = [&](const Spectral<N>& some) {
      return each([](float a, float b) { return b > 0.0f ? a / b : 0.0f; }, some, all);
    };
    return {over(scattering), over(none), all, fluorophores.emitted(wavelengths)};
  }

  /// What scatters alone.
  template <int N>
  BoundFluorescentPhase<N> bind(const Shading<N>& shading) const& {
    return {phase.bind(shading, parts(shading.wavelengths).scattered)};
  }
  template <int N>
  BoundFluorescentPhase<N> bind(const Shading<N>&) const&& = delete;
};

}  // namespace nocturne

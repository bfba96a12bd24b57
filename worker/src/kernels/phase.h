// How a medium scatters: albedo times a phase function, a density over directions that depends only
// on the angle by which a photon is turned. There is no surface: nothing but that angle matters,
// and the phase function is the same for both directions of transport.
#pragma once

#include <optional>
#include <utility>
#include <variant>

#include "kernels/henyey_greenstein.h"
#include "kernels/kernel.h"
#include "kernels/rayleigh_phase.h"
#include "kernels/tabulated_phase.h"
#include "spectrum/spectrum.h"

namespace nocturne {

template <int N>
class BoundPhase {
 public:
  using Shape = std::variant<HenyeyGreenstein, DoubleHenyeyGreenstein, BoundRayleigh<N>,
                             BoundTabulatedPhase<N>>;

  BoundPhase(const Spectral<N>& albedo, Shape shape) : albedo_(albedo), shape_(std::move(shape)) {}

  Spectral<N> albedo(Vec3) const { return albedo_; }
  Spectral<N> value(Vec3 wo, Vec3 wi) const {
    const auto angle = ScatteringAngle::between(wo, wi);
    return albedo_ *
           std::visit([&](const auto& s) { return Spectral<N>(s.density(angle)); }, shape_);
  }
  /// From the mean over the group's photons of their densities, by the path pdf ratios: no photon
  /// leaves its group.
  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t) const {
    const auto angle = std::visit([&](const auto& s) { return s.sample(numbers); }, shape_);
    return Draw<N>{.wi = angle.direction(wo, numbers.v)};
  }
  Spectral<N> pdf(Vec3 wo, Vec3 wi) const {
    const auto angle = ScatteringAngle::between(wo, wi);
    return std::visit(
        [&](const auto& s) {
          if constexpr (requires { s.mean_density(angle); }) {
            return s.mean_density(angle);
          } else {
            return s.density(angle);
          }
        },
        shape_);
  }
  /// How much more likely each photon is to be turned so than a draw is.
  Spectral<N> likelihood(Vec3 wo, Vec3 wi) const {
    const auto angle = ScatteringAngle::between(wo, wi);
    return std::visit(
        [&](const auto& s) -> Spectral<N> {
          if constexpr (requires { s.mean_density(angle); }) {
            const float mean = s.mean_density(angle);
            return mean > 0.0f ? s.density(angle) / mean : Spectral<N>(0.0f);
          } else {
            return 1.0f;
          }
        },
        shape_);
  }
  static constexpr bool smooth() { return true; }
  static constexpr bool transmits() { return true; }

  /// Of molecules and of tables that have a matrix; others depolarise.
  Mueller<N> mueller(Vec3 wo, Vec3 wi, std::uint32_t) const {
    const auto angle = ScatteringAngle::between(wo, wi);
    return std::visit(
        [&](const auto& s) {
          if constexpr (requires { s.mueller(angle); }) {
            return s.mueller(angle);
          } else {
            return Mueller<N>{};
          }
        },
        shape_);
  }

 private:
  Spectral<N> albedo_;
  Shape shape_;
};
static_assert(BoundKernel<BoundPhase<1>, 1> && BoundKernel<BoundPhase<4>, 4>);

struct Phase {
  /// Not negative, in a common unit.
  Spectrum absorption, scattering;
  std::variant<HenyeyGreenstein, DoubleHenyeyGreenstein, RayleighPhase, TabulatedPhase> shape;

  static constexpr bool has_delta_lobe() { return false; }
  static constexpr bool may_transmit() { return false; }

  template <int N>
  BoundPhase<N> bind(const Shading<N>& shading) const& {
    const Spectral<N> albedo =
        each([](float a, float s) { return s > 0.0f ? s / (a + s) : 0.0f; },
             absorption(shading.wavelengths), scattering(shading.wavelengths));
    return bind(shading, albedo);
  }
  /// Of another albedo.
  template <int N>
  BoundPhase<N> bind(const Shading<N>& shading, const Spectral<N>& albedo) const& {
    return {
        albedo,
        std::visit([&](const auto& s) { return typename BoundPhase<N>::Shape(s.bind(shading)); },
                   shape)};
  }
  /// The bound kernel may point into the table.
  template <int N>
  BoundPhase<N> bind(const Shading<N>&) const&& = delete;
};

}  // namespace nocturne

// How an interaction changes the polarisation of light, as the Mueller matrix from the Stokes
// vector that comes to the one that leaves, over the share of unpolarised light that leaves:
//   | 1  b  .  . |
//   | b  a  .  . |
//   | .  .  c -s |
//   | .  .  s  d |
// Both vectors refer to one direction across both rays, or, where light goes straight on, to the
// filter's axis: S1 is positive where the field is along it, S2 where it is along the middle
// between it and the direction that follows it counterclockwise as the receiver sees it, S3 where
// it turns clockwise as the receiver sees it. Waves go as e^(i k z). Born and Wolf, Principles of
// Optics, 7th ed., section 10.8; signs: docs/explanation/polarisation.md.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernels/thin_film.h"

namespace nocturne {

/// Of each photon. As it is made it depolarises: all that leaves is unpolarised.
template <int N>
struct Mueller {
  Spectral<N> b = 0.0f, a = 0.0f, c = 0.0f, d = 0.0f, s = 0.0f;
  /// The share of unpolarised light that leaves, over what the kernel's value says, which may take
  /// it for unpolarised within.
  Spectral<N> size = 1.0f;

  static Mueller unchanged() { return {0.0f, 1.0f, 1.0f, 1.0f, 0.0f, 1.0f}; }
  void keep(std::size_t photon) { a[photon] = c[photon] = d[photon] = 1.0f; }

  /// Of shares of the power along the direction and across it, and the mean product of both fields.
  void set(std::size_t photon, double along, double across, double product) {
    const double mean = 0.5 * (along + across);
    if (!(mean > 0.0)) return;
    b[photon] = static_cast<float>(0.5 * (along - across) / mean);
    a[photon] = 1.0f;
    c[photon] = d[photon] = static_cast<float>(product / mean);
  }
  /// Where the field along the direction is multiplied by the first number, and that across it by
  /// the second.
  void set(std::size_t photon, Complex along, Complex across) {
    const double mean = 0.5 * (along.norm() + across.norm());
    if (!(mean > 0.0)) return;
    const Complex product = along * Complex{across.re, -across.im};
    b[photon] = static_cast<float>(0.5 * (along.norm() - across.norm()) / mean);
    a[photon] = 1.0f;
    c[photon] = d[photon] = static_cast<float>(product.re / mean);
    s[photon] = static_cast<float>(product.im / mean);
  }
};

/// A kernel that knows its effect on polarised light; others depolarise it. `photons`: bit i,
/// whether anybody asks of photon i.
template <class B, int N>
concept Polarises = requires(const B& b, Vec3 wo, Vec3 wi, std::uint32_t photons) {
  { b.mueller(wo, wi, photons) } -> std::same_as<Mueller<N>>;
};

template <int N, class B>
Mueller<N> mueller_of(const B& kernel, Vec3 wo, Vec3 wi, std::uint32_t photons) {
  if constexpr (Polarises<B, N>) {
    return kernel.mueller(wo, wi, photons);
  } else {
    return {};
  }
}

}  // namespace nocturne

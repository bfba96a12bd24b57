// Phong's lobe, normalised: BRDF reflectance (n + 2) / (2 pi) cos^n of the angle to the mirror
// direction. Lafortune and Willems, "Using the Modified Phong Reflectance Model for Physically
// Based Rendering", KU Leuven report CW 197, 1994. What the lobe sends below the horizon is lost.
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/kernel.h"
#include "math/frame.h"
#include "math/functions.h"
#include "parameters/colour.h"

namespace nocturne {

/// cos^n, from 1 - cos, which single precision still knows where cos^n changes fast.
template <class T>
T phong_lobe(T exponent, T one_minus_cosine) {
  return one_minus_cosine < T(1) ? math::exp(exponent * math::log1p(-one_minus_cosine)) : T(0);
}

template <int N>
struct BoundPhong {
  Spectral<N> reflectance;
  float exponent;

  /// Reached at normal incidence; less where the lobe is cut by the horizon.
  Spectral<N> albedo(Vec3) const { return reflectance; }
  Evaluation<N> evaluate(Vec3 wo, Vec3 wi) const {
    if (wi.z <= 0.0f) return Evaluation<N>::nothing();
    const float l = lobe(wo, wi);
    return {0.5f * kInvPi * (exponent + 2.0f) * l * wi.z * reflectance,
            0.5f * kInvPi * (exponent + 1.0f) * l};
  }
  Spectral<N> value(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).value; }
  Spectral<N> pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }
  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t) const {
    // cos = (1 - u)^(1 / (n + 1))
    const float less = -math::expm1(math::log1p(-numbers.u) / (exponent + 1.0f));
    const float r = std::sqrt(std::max(0.0f, less * (2.0f - less)));
    const float phi = kTwoPi * numbers.v;
    const Frame frame(mirrored(wo));
    const Vec3 wi =
        normalized(frame.to_world({r * math::cos(phi), r * math::sin(phi), 1.0f - less}));
    if (wi.z <= 0.0f) return std::nullopt;
    return Draw<N>{.wi = wi};
  }
  static constexpr bool smooth() { return true; }
  static constexpr bool transmits() { return false; }

 private:
  static Vec3 mirrored(Vec3 wo) { return {-wo.x, -wo.y, wo.z}; }
  float lobe(Vec3 wo, Vec3 wi) const {
    const Vec3 d = wi - mirrored(wo);
    return phong_lobe(exponent, 0.5f * dot(d, d));
  }
};
static_assert(BoundKernel<BoundPhong<1>, 1> && BoundKernel<BoundPhong<4>, 4>);

struct Phong {
  /// In [0, 1].
  Colour reflectance;
  /// In [0, 1e6].
  float exponent;

  static constexpr bool has_delta_lobe() { return false; }
  static constexpr bool may_transmit() { return false; }

  template <int N>
  BoundPhong<N> bind(const Shading<N>& shading) const {
    return {reflectance(shading.point, shading.wavelengths), exponent};
  }
};

}  // namespace nocturne

// What every kernel is: the way a surface (later a medium) scatters. A kernel is first bound to a
// photon's wavelength, which evaluates its spectra once; the bound kernel answers four questions in
// the local frame, normal along +z, with `wo` where the photon came from and `wi` where it goes,
// both pointing away from the surface, wo.z > 0.
#pragma once

#include <concepts>
#include <optional>

#include "math/vec3.h"
#include "pdfs/directions.h"

namespace nocturne {

template <class B>
concept BoundKernel = requires(const B& b, Vec3 wo, Vec3 wi, float u) {
  /// H: the integral of value over wi, in [0, 1].
  { b.albedo(wo) } -> std::same_as<float>;
  /// BRDF times cosine (or phase function times albedo), 1/sr, not negative.
  { b.value(wo, wi) } -> std::same_as<float>;
  /// A direction from two uniform numbers; empty where none is drawn.
  { b.sample(wo, u, u) } -> std::same_as<std::optional<Vec3>>;
  /// Density of sample, 1/sr.
  { b.pdf(wo, wi) } -> std::same_as<float>;
};

/// The default sampling of an opaque kernel, which any other must agree with. Inherit it to start a
/// new kernel.
struct UniformSampling {
  static std::optional<Vec3> sample(Vec3, float u1, float u2) {
    return UniformHemisphere::sample(u1, u2);
  }
  static float pdf(Vec3, Vec3 wi) { return UniformHemisphere::pdf(wi); }
};

}  // namespace nocturne

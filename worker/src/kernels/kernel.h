// The interface of every kernel: how a surface or a medium scatters. A kernel is first bound to the
// wavelengths of a group of photons and a point, which evaluates its spectra once; the bound kernel
// answers questions in the local frame, normal along +z on the side that the photon came from, with
// `wo` where it came from and `wi` where it goes, both unit, pointing away from the surface, wo.z >
// 0. Directions with wi.z < 0 leave on the other side.
//
// A kernel may have a smooth part, with a density over directions, and delta parts (mirror, smooth
// glass), which send photons along single directions.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "math/vec3.h"
#include "parameters/surface_point.h"
#include "pdfs/directions.h"
#include "spectrum/spectral.h"

namespace nocturne {

/// What the photon carries, which matters where the index of refraction changes: radiance scales
/// with its square, flux doesn't.
enum class Transport {
  kAdjoint,  // from the sensor; measures radiance
  kForward,  // from the luminaires; carries flux
};

/// What a kernel may depend on besides directions.
template <int N>
struct Shading {
  /// nm, one for each photon.
  Spectral<N> wavelengths;
  /// Of refraction: on the side that the photon came from, and beyond.
  Spectral<N> index_from = 1.0f, index_to = 1.0f;
  SurfacePoint point = {};
  Transport transport = Transport::kAdjoint;
  /// How likely each photon would have been to come here, among media; sum 1.
  Spectral<N> path_pdf_ratio = 1.0f / N;
};

/// Three uniform numbers in [0, 1): `part` chooses between parts of the kernel, u and v the
/// direction.
struct KernelNumbers {
  float part, u, v;
  /// For pilots that look for rare light: a smooth boundary mirrors half of what meets it, though
  /// it mirrors little, and the weight is by so much less; kOfSquare: by the root of that, for
  /// weights that are squared, as the mean square is that of photons which chance chose.
  enum class Halves : std::uint8_t { kNo, kYes, kOfSquare } halves = Halves::kNo;

  /// Factor of a weight where a part is drawn half of the times instead of with `probability`.
  float halved(float probability) const {
    return halves == Halves::kOfSquare ? std::sqrt(2.0f * probability) : 2.0f * probability;
  }
};

template <int N>
inline constexpr std::uint32_t kAllCoherent = (1u << N) - 1u;

template <int N>
struct Draw {
  Vec3 wi;
  /// Drawn from a delta part: `factor` is that part's value over its probability, for each photon.
  bool delta = false;
  Spectral<N> factor = 1.0f;
  /// Bit i: photon i would have drawn the same from the same numbers. The others leave the group.
  std::uint32_t coherent = kAllCoherent<N>;
  /// Which part of a blend drew.
  std::uint32_t part = 0;

  /// Photons that drew nothing while others of the group may draw something: their paths end here.
  static Draw ended(std::uint32_t coherent) {
    return {.wi = {0.0f, 0.0f, 1.0f}, .delta = true, .factor = 0.0f, .coherent = coherent};
  }
};

/// Of the smooth part in one direction: value, and density of `sample`, as BoundKernel says.
template <int N>
struct Evaluation {
  Spectral<N> value, pdf;

  static Evaluation nothing() { return {0.0f, 0.0f}; }
};

template <class B, int N>
concept BoundKernel = requires(const B& b, Vec3 wo, Vec3 wi, const KernelNumbers& numbers,
                               std::size_t lead) {
  /// H: the share of the energy that goes on, over all wi and parts, in [0, 1].
  { b.albedo(wo) } -> std::same_as<Spectral<N>>;
  /// Of the smooth part: BRDF or BTDF times cosine (or phase function times albedo), 1/sr, not
  /// negative.
  { b.value(wo, wi) } -> std::same_as<Spectral<N>>;
  /// A direction for photon `lead`; empty where no photon of the group draws one. Where only
  /// some draw none, a delta draw with factor 0.
  { b.sample(wo, numbers, lead) } -> std::same_as<std::optional<Draw<N>>>;
  /// Density of sample over directions, 1/sr, for each photon. Integrates to 1 less the
  /// probability of the delta parts.
  { b.pdf(wo, wi) } -> std::same_as<Spectral<N>>;
  /// Whether there is a smooth part.
  { b.smooth() } -> std::same_as<bool>;
  /// Whether the smooth part sends anything to the other side.
  { b.transmits() } -> std::same_as<bool>;
};

/// A bound kernel that answers for value and density coherent with less work than one by one.
template <class B, int N>
concept EvaluatesTogether = requires(const B& b, Vec3 wo, Vec3 wi) {
  /// The same bits as value and pdf.
  { b.evaluate(wo, wi) } -> std::same_as<Evaluation<N>>;
};

template <int N, class B>
Evaluation<N> evaluate(const B& kernel, Vec3 wo, Vec3 wi) {
  if constexpr (EvaluatesTogether<B, N>) {
    return kernel.evaluate(wo, wi);
  } else {
    return {kernel.value(wo, wi), kernel.pdf(wo, wi)};
  }
}

/// What a kernel says of itself before it is bound, so that a scene can be prepared for it; a blend
/// is asked for its parts instead.
template <class K>
concept DescribedKernel = requires(const K& kernel) {
  /// Whether photons may be mirrored or pass along single directions, for some wavelength and
  /// point.
  { kernel.has_delta_lobe() } -> std::same_as<bool>;
  /// Whether photons may go through a surface of it.
  { kernel.may_transmit() } -> std::same_as<bool>;
};

/// The default sampling of an opaque kernel, which any other must agree with. Inherit it to start a
/// new kernel.
template <int N>
struct UniformSampling {
  static std::optional<Draw<N>> sample(Vec3, const KernelNumbers& numbers, std::size_t) {
    return Draw<N>{.wi = UniformHemisphere::sample(numbers.u, numbers.v)};
  }
  static Spectral<N> pdf(Vec3, Vec3 wi) { return UniformHemisphere::pdf(wi); }
  static constexpr bool smooth() { return true; }
  static constexpr bool transmits() { return false; }
};

/// The same for one that transmits.
template <int N>
struct UniformSphereSampling {
  static std::optional<Draw<N>> sample(Vec3, const KernelNumbers& numbers, std::size_t) {
    return Draw<N>{.wi = UniformSphere::sample(numbers.u, numbers.v)};
  }
  static Spectral<N> pdf(Vec3, Vec3) { return UniformSphere::pdf(); }
  static constexpr bool smooth() { return true; }
  static constexpr bool transmits() { return true; }
};

}  // namespace nocturne

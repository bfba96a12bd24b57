// The boundary between two dielectrics: smooth, or GGX microfacets with single scattering.
// Walter et al., EGSR 2007, equations 20 (reflection) and 21 (refraction), D and G2 as in ggx.h and
// beckmann.h. Radiance that crosses the boundary scales with the square of the index, so an adjoint
// photon's transmission carries (index_from / index_to)^2 and a forward one's doesn't: Veach, PhD
// thesis, Stanford 1997, section 5.2.
//
// Each photon reflects with the probability that Fresnel's equations give it, so those of a group
// part where they decide differently, and where they refract into different directions. Layers on
// the boundary change that probability (thin_film.h); of the light that they don't absorb it is
// then the share, and weights are by so much less.
#pragma once

#include <algorithm>
#include <array>

#include "kernels/fresnel.h"
#include "kernels/kernel.h"
#include "kernels/mueller.h"
#include "kernels/roughness.h"
#include "kernels/thin_film.h"

namespace nocturne {

template <int N>
struct BoundDielectric {
  /// index_to / index_from.
  Spectral<N> ratio;
  /// Of transmission.
  Spectral<N> scale;
  BoundRoughness roughness;
  BoundThinFilm<N> film = {};

  Spectral<N> albedo(Vec3 wo) const {
    if (!film) return 1.0f;
    return of_each([&](std::size_t i) { return split(wo.z, i).kept; });
  }

  Evaluation<N> evaluate(Vec3 wo, Vec3 wi) const {
    if (roughness.smooth) return Evaluation<N>::nothing();
    const bool reflects = wi.z > 0.0f;
    const float weight = reflects ? roughness.facets.reflection_weight(wo, wi)
                                  : roughness.facets.transmission_weight(wo, wi);
    if (film) return evaluate_with_film(wo, wi, reflects ? Spectral<N>(weight) : weight * scale);
    const Spectral<N> drawn = pdf(wo, wi), weighed = weight * drawn;
    return {reflects ? weighed : weighed * scale, drawn};
  }
  Spectral<N> value(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).value; }

  Spectral<N> pdf(Vec3 wo, Vec3 wi) const {
    if (roughness.smooth || wi.z == 0.0f) return 0.0f;
    if (film) return evaluate_with_film(wo, wi, 0.0f).pdf;
    return each_distinct([&](float n) { return rough_pdf(wo, wi, n); }, ratio);
  }

  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t lead) const {
    const bool delta = roughness.smooth;
    if (passes(ratio[lead])) {
      return Draw<N>{.wi = -wo, .delta = true, .factor = scale, .coherent = those([&](float r) {
                                                                  return passes(r);
                                                                })};
    }
    if (film) return sample_with_film(wo, numbers, lead);
    const Vec3 h =
        delta ? Vec3{0.0f, 0.0f, 1.0f} : roughness.facets.sample_visible(wo, numbers.u, numbers.v);
    const float cosine = std::clamp(dot(wo, h), 0.0f, 1.0f);
    if (delta && numbers.halves != KernelNumbers::Halves::kNo)
      return half(wo, cosine, numbers, lead);
    if (numbers.part < reflectance(cosine, ratio[lead])) {
      const auto coherent =
          those([&](float r) { return !passes(r) && numbers.part < reflectance(cosine, r); });
      const Vec3 wi = delta ? Vec3{-wo.x, -wo.y, wo.z} : normalized(reflected(wo, h));
      if (wi.z <= 0.0f) return Draw<N>::ended(coherent);
      return Draw<N>{.wi = wi, .delta = delta, .coherent = coherent};
    }
    const auto coherent = those([&](float r) { return r == ratio[lead]; });
    const Vec3 wi = refracted(wo, h, cosine, ratio[lead]);
    if (wi.z >= 0.0f) return Draw<N>::ended(coherent);
    return Draw<N>{.wi = wi, .delta = delta, .factor = delta ? scale : 1.0f, .coherent = coherent};
  }

  bool smooth() const {
    return !roughness.smooth && those([&](float r) { return !passes(r); }) != 0u;
  }
  bool transmits() const { return smooth(); }

  /// Each photon separately: refracted light has the facet of the photon's index.
  Mueller<N> mueller(Vec3 wo, Vec3 wi, std::uint32_t photons) const {
    const bool reflects = wi.z > 0.0f;
    Mueller<N> found;
    for (std::size_t i = 0; i < N; ++i) {
      if (((photons >> i) & 1u) == 0u) continue;
      if (passes(ratio[i])) {
        found.keep(i);
        continue;
      }
      const float cosine = roughness.smooth ? wo.z
                           : reflects       ? dot(wo, half_vector(wo, wi))
                                            : dot(wo, half_vector(wo, wi, ratio[i]));
      if (!film) {
        found.set_face(i, std::clamp(cosine, 0.0f, 1.0f), ratio[i], reflects);
        continue;
      }
      const auto by = film.amplitudes(std::clamp(cosine, 0.0f, 1.0f), i, ratio[i]);
      if (reflects) {
        found.set(i, by.s.reflected, by.p.reflected);
      } else {
        found.set(i, by.s.transmitted, by.p.transmitted);
      }
    }
    return found;
  }

 private:
  /// Of a wavelength: the probability of being mirrored, and the share that layers don't absorb.
  struct Split {
    float mirrors, kept;
  };
  Split split(float cosine, std::size_t i) const {
    const Shares shares = film(static_cast<double>(cosine), i, static_cast<double>(ratio[i]));
    const double kept = shares.reflected + shares.transmitted;
    return {kept > 0.0 ? static_cast<float>(shares.reflected / kept) : 1.0f,
            static_cast<float>(kept)};
  }

  std::optional<Draw<N>> sample_with_film(Vec3 wo, const KernelNumbers& numbers,
                                          std::size_t lead) const {
    const bool delta = roughness.smooth;
    const Vec3 h =
        delta ? Vec3{0.0f, 0.0f, 1.0f} : roughness.facets.sample_visible(wo, numbers.u, numbers.v);
    const float cosine = std::clamp(dot(wo, h), 0.0f, 1.0f);
    std::array<Split, N> splits;
    for (std::size_t i = 0; i < N; ++i) splits[i] = split(cosine, i);
    // Half of the photons are mirrored: all where they are reflected totally.
    const bool halved = delta && numbers.halves != KernelNumbers::Halves::kNo;
    const auto probability = [&](std::size_t i) {
      return halved && splits[i].mirrors < 1.0f ? 0.5f : splits[i].mirrors;
    };
    const bool mirrored = numbers.part < probability(lead);
    std::uint32_t coherent = 0;
    for (std::size_t i = 0; i < N; ++i) {
      const bool same = mirrored == (numbers.part < probability(i)) && !passes(ratio[i]) &&
                        (mirrored || ratio[i] == ratio[lead]);
      coherent |= same ? 1u << i : 0u;
    }
    const Vec3 wi = !mirrored ? refracted(wo, h, cosine, ratio[lead])
                    : delta   ? Vec3{-wo.x, -wo.y, wo.z}
                              : normalized(reflected(wo, h));
    if (mirrored ? wi.z <= 0.0f : wi.z >= 0.0f) return Draw<N>::ended(coherent);
    if (!delta) return Draw<N>{.wi = wi, .coherent = coherent};
    Spectral<N> factor = of_each([&](std::size_t i) {
      const float less = mirrored ? splits[i].mirrors : 1.0f - splits[i].mirrors;
      return splits[i].kept * (probability(i) == splits[i].mirrors ? 1.0f : numbers.halved(less));
    });
    if (!mirrored) factor *= scale;
    return Draw<N>{.wi = wi, .delta = true, .factor = factor, .coherent = coherent};
  }

  /// Smooth, half of the photons mirrored; all where they are reflected totally.
  std::optional<Draw<N>> half(Vec3 wo, float cosine, const KernelNumbers& numbers,
                              std::size_t lead) const {
    const auto total = [&](float r) { return reflectance(cosine, r) >= 1.0f; };
    const Vec3 mirrored{-wo.x, -wo.y, wo.z};
    if (total(ratio[lead])) {
      return Draw<N>{.wi = mirrored, .delta = true, .coherent = those([&](float r) {
                                                      return !passes(r) && total(r);
                                                    })};
    }
    if (numbers.part < 0.5f) {
      return Draw<N>{
          .wi = mirrored,
          .delta = true,
          .factor = each([&](float r) { return numbers.halved(reflectance(cosine, r)); }, ratio),
          .coherent = those([&](float r) { return !passes(r) && !total(r); })};
    }
    const auto coherent = those([&](float r) { return r == ratio[lead]; });
    const Vec3 wi = refracted(wo, {0.0f, 0.0f, 1.0f}, cosine, ratio[lead]);
    if (wi.z >= 0.0f) return Draw<N>::ended(coherent);
    const float less = numbers.halved(1.0f - reflectance(cosine, ratio[lead]));
    return Draw<N>{.wi = wi, .delta = true, .factor = less * scale, .coherent = coherent};
  }

  /// Equal indices: no boundary, unless a film is between them. Of a rough one also where the
  /// indices are so close that single precision can't tell the facet from the two directions (less
  /// than 1e-10 is reflected there, without a film).
  bool passes(float r) const {
    return (r == 1.0f && !film) || (!roughness.smooth && std::fabs(r - 1.0f) < 2e-5f);
  }

  template <class F>
  static Spectral<N> of_each(const F& f) {
    Spectral<N> r;
    for (std::size_t i = 0; i < N; ++i) r[i] = f(i);
    return r;
  }

  template <class Condition>
  std::uint32_t those(const Condition& condition) const {
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < N; ++i) mask |= condition(ratio[i]) ? 1u << i : 0u;
    return mask;
  }

  /// In double: indices may differ by little.
  static float reflectance(float cosine, float r) {
    return static_cast<float>(fresnel_dielectric<double>(cosine, r));
  }

  static Vec3 refracted(Vec3 wo, Vec3 h, float cosine, float r) {
    const float g = std::sqrt(std::max(0.0f, (r - 1.0f) * (r + 1.0f) + cosine * cosine));
    return normalized((cosine - g) * h - wo);
  }

  float rough_pdf(Vec3 wo, Vec3 wi, float r) const {
    if (passes(r)) return 0.0f;
    if (wi.z > 0.0f) {
      const Vec3 h = half_vector(wo, wi);
      return reflectance(std::clamp(dot(wo, h), 0.0f, 1.0f), r) *
             roughness.facets.reflection_pdf(wo, h);
    }
    const Refraction by = refraction(wo, wi, r);
    if (by.visible == 0.0) return 0.0f;
    return static_cast<float>((1.0 - fresnel_dielectric(by.thinner, by.ratio)) * by.visible *
                              by.jacobian);
  }

  Evaluation<N> evaluate_with_film(Vec3 wo, Vec3 wi, const Spectral<N>& weight) const {
    auto found = Evaluation<N>::nothing();
    for (std::size_t i = 0; i < N; ++i) {
      const float r = ratio[i];
      if (passes(r)) continue;
      Split at{};
      if (wi.z > 0.0f) {
        const Vec3 h = half_vector(wo, wi);
        at = split(std::clamp(dot(wo, h), 0.0f, 1.0f), i);
        found.pdf[i] = at.mirrors * roughness.facets.reflection_pdf(wo, h);
      } else {
        const Refraction by = refraction(wo, wi, r);
        if (by.visible == 0.0) continue;
        at = split(by.here(r), i);
        const double passing = 1.0 - static_cast<double>(at.mirrors);
        found.pdf[i] = static_cast<float>(passing * by.visible * by.jacobian);
      }
      found.value[i] = weight[i] * at.kept * found.pdf[i];
    }
    return found;
  }

  /// By the facet that refracts wo into wi: how much of it is seen from wo, and the density of wi
  /// for that of the facet. `thinner` is its cosine on the thinner side, `ratio` the index beyond
  /// over that of the thinner side.
  struct Refraction {
    double visible = 0.0, jacobian = 0.0, thinner = 0.0, ratio = 1.0;

    /// The cosine on the side of the light, `r` being the index beyond over that here.
    float here(float r) const {
      if (r > 1.0f) return static_cast<float>(thinner);
      return static_cast<float>(std::sqrt((ratio - 1.0) * (ratio + 1.0) + thinner * thinner) /
                                ratio);
    }
  };

  Refraction refraction(Vec3 wo, Vec3 wi, float r) const {
    const Vec3 h = half_vector(wo, wi, r);
    const float o = dot(wo, h), i = dot(wi, h);
    if (!(o > 0.0f && i < 0.0f)) return {};
    // Walter's equation 17, r^2 |wi.h| / (wo.h + r wi.h)^2, without the difference: with the cosine
    // c on the thinner side and the index ratio n > 1, the other side's is g / n, g^2 = n^2 - 1 +
    // c^2, and both factors are sums. From the denser side g would itself be a difference.
    const bool from_thinner = r > 1.0f;
    const double n = from_thinner ? static_cast<double>(r) : 1.0 / static_cast<double>(r);
    const double c = std::min(1.0, static_cast<double>(from_thinner ? o : -i));
    const double contrast = (n - 1.0) * (n + 1.0), g = std::sqrt(contrast + c * c);
    const double root = (g + c) / contrast;
    const double jacobian = (from_thinner ? n * g : c) * root * root;
    return {static_cast<double>(roughness.facets.visible(wo, h)), jacobian, c, n};
  }
};
static_assert(BoundKernel<BoundDielectric<1>, 1> && BoundKernel<BoundDielectric<4>, 4>);

/// The indices of refraction come with the shading: a photon knows its medium.
struct Dielectric {
  Roughness roughness;
  /// In the order in which light meets the layers.
  ThinFilm film = {};

  bool has_delta_lobe() const { return roughness.may_be_smooth(); }
  static constexpr bool may_transmit() { return true; }

  template <int N>
  BoundDielectric<N> bind(const Shading<N>& shading) const {
    const Spectral<N> inverse = shading.index_from / shading.index_to;
    return {shading.index_to / shading.index_from,
            shading.transport == Transport::kAdjoint ? inverse * inverse : Spectral<N>(1.0f),
            roughness(shading.point), bound_thin_film(film, shading)};
  }
};

}  // namespace nocturne

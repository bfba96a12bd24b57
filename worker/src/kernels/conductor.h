// Metal with the complex index n + i k: a mirror, or GGX microfacets with single scattering.
//   BRDF = F(wo.h) D(h) G2(wo, wi) / (4 cos cos)
// Walter et al. 2007, equation 20; D and G2 as in ggx.h and beckmann.h, F as in fresnel.h. Light
// that bounces between facets is lost, as in the model's source: at roughness 1 up to two thirds.
// With layers on it F is that of the film (thin_film.h), at each facet.
#pragma once

#include <algorithm>
#include <utility>

#include "kernels/fresnel.h"
#include "kernels/kernel.h"
#include "kernels/mueller.h"
#include "kernels/roughness.h"
#include "kernels/thin_film.h"
#include "spectrum/spectrum.h"

namespace nocturne {

template <int N>
struct BoundConductor {
  /// Relative to the index on the side of the light.
  Spectral<N> n, k;
  BoundRoughness roughness;
  BoundThinFilm<N> film = {};

  /// Of a mirror: more than a rough one sends on, up to the dependence of F on the angle.
  Spectral<N> albedo(Vec3 wo) const { return fresnel(std::min(1.0f, wo.z)); }

  Evaluation<N> evaluate(Vec3 wo, Vec3 wi) const {
    if (roughness.smooth || wi.z <= 0.0f) return Evaluation<N>::nothing();
    const Vec3 h = half_vector(wo, wi);
    const Facets& facets = roughness.facets;
    const float mirrored = facets.reflection_pdf(wo, h);
    return {
        mirrored * facets.reflection_weight(wo, wi) * fresnel(std::clamp(dot(wo, h), 0.0f, 1.0f)),
        mirrored};
  }
  Spectral<N> value(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).value; }
  Spectral<N> pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }

  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t) const {
    if (roughness.smooth) {
      return Draw<N>{.wi = {-wo.x, -wo.y, wo.z}, .delta = true, .factor = albedo(wo)};
    }
    const Vec3 h = roughness.facets.sample_visible(wo, numbers.u, numbers.v);
    const Vec3 wi = normalized(reflected(wo, h));
    if (wi.z <= 0.0f) return std::nullopt;
    return Draw<N>{.wi = wi};
  }

  bool smooth() const { return !roughness.smooth; }
  static constexpr bool transmits() { return false; }

  Mueller<N> mueller(Vec3 wo, Vec3 wi, std::uint32_t photons) const {
    const float cosine = roughness.smooth ? wo.z : dot(wo, half_vector(wo, wi));
    Mueller<N> found;
    for (std::size_t i = 0; i < N; ++i) {
      if (((photons >> i) & 1u) == 0u) continue;
      const auto by = film.amplitudes(std::clamp(cosine, 0.0f, 1.0f), i, n[i], k[i]);
      found.set(i, by.s.reflected, by.p.reflected);
    }
    return found;
  }

 private:
  Spectral<N> fresnel(float cosine) const {
    if (film) {
      Spectral<N> r;
      for (std::size_t i = 0; i < N; ++i)
        r[i] = static_cast<float>(film(double{cosine}, i, double{n[i]}, double{k[i]}).reflected);
      return r;
    }
    return each([cosine](float a, float b) { return fresnel_conductor(cosine, a, b); }, n, k);
  }
};
static_assert(BoundKernel<BoundConductor<1>, 1> && BoundKernel<BoundConductor<4>, 4>);

struct Conductor {
  /// Against vacuum, not negative.
  Spectrum n, k;
  Roughness roughness;
  ThinFilm film = {};

  bool has_delta_lobe() const { return roughness.may_be_smooth(); }
  static constexpr bool may_transmit() { return false; }

  template <int N>
  BoundConductor<N> bind(const Shading<N>& shading) const {
    return {n(shading.wavelengths) / shading.index_from,
            k(shading.wavelengths) / shading.index_from, roughness(shading.point),
            bound_thin_film(film, shading)};
  }
};

}  // namespace nocturne

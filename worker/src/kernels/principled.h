// The principled surface that exchange formats have in common: a diffuse base under a dielectric,
// or metal, or something between the two, and a clear coat over all. After B. Burley,
// "Physically-Based Shading at Disney", SIGGRAPH 2012 course, and the OpenPBR surface 1.1, with
// these parts:
//   metal       GGX facets, Schlick's reflectance F = base + (1 - base) (1 - cos)^5
//   dielectric  GGX facets of the same alpha, Fresnel's reflectance of the index
//   base        (base / pi) (1 - E(wo)) (1 - E(wi)) / mean(1 - E), E what dielectric and coat
//               reflect (C. Kelemen and L. Szirmay-Kalos, Eurographics 2001 short papers,
//               section 2.1): so that E + (1 - E) base leaves
//   coat        GGX facets of its own alpha and index; what is below gets 1 less the larger of
//               what the coat reflects of wo and of wi; its index is taken against vacuum
// Light that bounces between facets of metal is kept (ggx_energy.h), that of dielectrics goes
// below. Alpha is the square of roughness. Each part is reciprocal. No sheen, no subsurface
// scattering; what is seen through is another kernel's.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "kernels/fresnel.h"
#include "kernels/ggx_energy.h"
#include "kernels/kernel.h"
#include "kernels/rough_fresnel.h"
#include "kernels/roughness.h"
#include "parameters/colour.h"
#include "spectrum/spectrum.h"

namespace nocturne {

/// Schlick's (1 - cos)^5.
inline float schlick_weight(float cosine) {
  const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f), m2 = m * m;
  return m2 * m2 * m;
}

/// A boundary of facets for one wavelength, and how much of it is there.
struct PartialCoat {
  float amount, ratio;
  BoundRoughness roughness;

  bool there() const { return amount > 0.0f; }
  /// What it reflects of light from w.
  float reflectance(float cosine) const {
    if (!there()) return 0.0f;
    if (roughness.smooth) {
      return amount *
             static_cast<float>(fresnel_dielectric<double>(
                 static_cast<double>(std::clamp(cosine, 0.0f, 1.0f)), static_cast<double>(ratio)));
    }
    // At the first facet, of which a part is shadowed: that goes below.
    const float alpha = roughness.facets.alpha_u;
    return amount * RoughFresnel::instance().reflectance(cosine, alpha, ratio) *
           GgxEnergy::instance().reflected(cosine, alpha);
  }
};

template <int N>
struct BoundPrincipled {
  Spectral<N> base;
  float metallic;
  /// Of the dielectric against outside.
  Spectral<N> ratio;
  BoundRoughness roughness;
  PartialCoat coat;
  /// 1 / mean(1 - E) of dielectric and coat.
  Spectral<N> diffuse_scale;
  /// Of all wavelengths, for the choice between parts.
  float mean_base, mean_ratio;

  Spectral<N> albedo(Vec3 wo) const {
    const float coated = coat.reflectance(wo.z), schlick = schlick_weight(wo.z);
    return each(
        [&](float b, float n) {
          const float e = dielectric(wo.z, n);
          const float below =
              metallic * (b + (1.0f - b) * schlick) + (1.0f - metallic) * (e + (1.0f - e) * b);
          return std::min(1.0f, coated + (1.0f - coated) * below);
        },
        base, ratio);
  }

  Spectral<N> value(Vec3 wo, Vec3 wi) const {
    if (wi.z <= 0.0f) return 0.0f;
    const Vec3 h = half_vector(wo, wi);
    const float facing = std::clamp(dot(wo, h), 0.0f, 1.0f);
    const float coat_out = coat.reflectance(wo.z), coat_in = coat.reflectance(wi.z);
    const float through = 1.0f - std::max(coat_out, coat_in);
    Spectral<N> r = diffuse(wo, wi, coat_out, coat_in);
    if (!roughness.smooth) {
      const Facets& facets = roughness.facets;
      const float once = facets.reflection_pdf(wo, h) * facets.reflection_weight(wo, wi);
      const float schlick = schlick_weight(facing);
      r += through * once *
           each([&](float b, float n) { return facet_reflectance(facing, schlick, b, n); }, base,
                ratio);
      r += through * many_bounces(wo, wi);
    }
    if (coat.there() && !coat.roughness.smooth) {
      const Facets& facets = coat.roughness.facets;
      const auto fresnel = static_cast<float>(
          fresnel_dielectric<double>(static_cast<double>(facing), static_cast<double>(coat.ratio)));
      r += Spectral<N>(coat.amount * facets.reflection_pdf(wo, h) *
                       facets.reflection_weight(wo, wi) * fresnel);
    }
    return r;
  }

  Spectral<N> diffuse_value(Vec3 wo, Vec3 wi) const {
    if (wi.z <= 0.0f) return 0.0f;
    return diffuse(wo, wi, coat.reflectance(wo.z), coat.reflectance(wi.z));
  }

  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t) const {
    const Choice choice = choose(wo);
    const Vec3 mirror{-wo.x, -wo.y, wo.z};
    if (numbers.part < choice.coat) {
      if (coat.roughness.smooth) {
        return Draw<N>{.wi = mirror, .delta = true, .factor = coat.reflectance(wo.z) / choice.coat};
      }
      return off_facets(wo, coat.roughness.facets, numbers);
    }
    if (numbers.part < choice.coat + choice.facets) {
      if (roughness.smooth) {
        const float share = (1.0f - coat.reflectance(wo.z)) / choice.facets;
        const float schlick = schlick_weight(wo.z);
        return Draw<N>{
            .wi = mirror,
            .delta = true,
            .factor = share *
                      each([&](float b, float n) { return facet_reflectance(wo.z, schlick, b, n); },
                           base, ratio)};
      }
      return off_facets(wo, roughness.facets, numbers);
    }
    return Draw<N>{.wi = CosineHemisphere::sample(numbers.u, numbers.v)};
  }

  Spectral<N> pdf(Vec3 wo, Vec3 wi) const {
    if (wi.z <= 0.0f) return 0.0f;
    const Choice choice = choose(wo);
    const Vec3 h = half_vector(wo, wi);
    float p = choice.diffuse() * CosineHemisphere::pdf(wi);
    if (!roughness.smooth) p += choice.facets * roughness.facets.reflection_pdf(wo, h);
    if (coat.there() && !coat.roughness.smooth)
      p += choice.coat * coat.roughness.facets.reflection_pdf(wo, h);
    return p;
  }

  bool smooth() const {
    return !roughness.smooth || metallic < 1.0f || (coat.there() && !coat.roughness.smooth);
  }
  static constexpr bool transmits() { return false; }

 private:
  /// Probabilities of the parts; the same for all wavelengths.
  struct Choice {
    float coat, facets;
    float diffuse() const { return std::max(0.0f, 1.0f - coat - facets); }
  };

  /// Whether anything is evenly spread: the base, or what bounces between facets.
  bool spreads() const { return metallic < 1.0f || !roughness.smooth; }

  Choice choose(Vec3 wo) const {
    // No part is left out: at some wavelength the average may be far off.
    constexpr float kMin = 1.0f / 16.0f;
    const float coated = coat.reflectance(wo.z), left = 1.0f - coated;
    const float e = dielectric(wo.z, mean_ratio);
    const float metal = mean_base + (1.0f - mean_base) * schlick_weight(wo.z);
    const float shiny = left * (metallic * metal + (1.0f - metallic) * e);
    const float spread = left * (1.0f - metallic) * (1.0f - e) * mean_base;
    const float total = std::max(1e-6f, coated + shiny + spread);
    Choice choice{coat.there() ? std::max(kMin, coated / total) : 0.0f,
                  std::max(kMin, shiny / total)};
    const float diffuse = spreads() ? std::max(kMin, spread / total) : 0.0f;
    const float sum = choice.coat + choice.facets + diffuse;
    choice.coat /= sum;
    choice.facets = diffuse > 0.0f ? choice.facets / sum : 1.0f - choice.coat;
    return choice;
  }

  static std::optional<Draw<N>> off_facets(Vec3 wo, const Facets& facets,
                                           const KernelNumbers& numbers) {
    const Vec3 wi = normalized(reflected(wo, facets.sample_visible(wo, numbers.u, numbers.v)));
    if (wi.z <= 0.0f) return std::nullopt;
    return Draw<N>{.wi = wi};
  }

  float dielectric(float cosine, float n) const {
    return PartialCoat{1.0f, n, roughness}.reflectance(cosine);
  }

  float facet_reflectance(float cosine, float schlick, float b, float n) const {
    const float metal = b + (1.0f - b) * schlick;
    if (metallic >= 1.0f) return metal;
    const auto clear = static_cast<float>(
        fresnel_dielectric<double>(static_cast<double>(cosine), static_cast<double>(n)));
    return metallic * metal + (1.0f - metallic) * clear;
  }

  Spectral<N> diffuse(Vec3 wo, Vec3 wi, float coat_out, float coat_in) const {
    if (metallic >= 1.0f) return 0.0f;
    const float cosine = (1.0f - metallic) * kInvPi * wi.z * (1.0f - coat_out) * (1.0f - coat_in);
    return cosine * diffuse_scale *
           each(
               [&](float b, float n) {
                 return b * (1.0f - dielectric(wo.z, n)) * (1.0f - dielectric(wi.z, n));
               },
               base, ratio);
  }

  /// What leaves metal after several bounces between facets; of a dielectric it goes to the base.
  Spectral<N> many_bounces(Vec3 wo, Vec3 wi) const {
    if (metallic <= 0.0f) return 0.0f;
    const GgxEnergy& energy = GgxEnergy::instance();
    const float alpha = roughness.facets.alpha_u, mean = energy.mean(alpha);
    const float lost = (1.0f - energy.reflected(wo.z, alpha)) *
                       (1.0f - energy.reflected(wi.z, alpha)) / std::max(1e-6f, 1.0f - mean);
    // Schlick's mean over evenly incident light.
    return metallic * lost * kInvPi * wi.z *
           each([&](float b) { return GgxEnergy::left(b + (1.0f - b) / 21.0f, mean); }, base);
  }
};
static_assert(BoundKernel<BoundPrincipled<1>, 1> && BoundKernel<BoundPrincipled<4>, 4> &&
              BoundKernel<BoundPrincipled<8>, 8>);

class Principled {
 public:
  struct ClearCoat {
    /// In [0, 1]; alpha is the square of roughness.
    Scalar amount, roughness;
    float index;
  };

  /// Base in [0, 1]; metallic and roughness in [0, 1]; index against vacuum.
  Principled(Colour base, Scalar metallic, Scalar roughness, Spectrum index, ClearCoat coat)
      : base_(std::move(base)),
        metallic_(std::move(metallic)),
        roughness_(std::move(roughness)),
        index_(std::move(index)),
        coat_(std::move(coat)),
        mean_base_(base_.mean()),
        mean_index_(index_.mean()) {
    RoughFresnel::instance();  // made while loading, not while tracing
    GgxEnergy::instance();
  }

  bool has_delta_lobe() const {
    const auto amount = coat_.amount.constant();
    return may_be_smooth(roughness_) ||
           ((!amount || *amount > 0.0f) && may_be_smooth(coat_.roughness));
  }
  static constexpr bool may_transmit() { return false; }

  template <int N>
  BoundPrincipled<N> bind(const Shading<N>& shading) const {
    const BoundRoughness roughness = facets(roughness_, shading.point);
    const Spectral<N> ratio = index_(shading.wavelengths) / shading.index_from;
    const PartialCoat coat{coat_.amount(shading.point), coat_.index,
                           facets(coat_.roughness, shading.point)};
    Spectral<N> scale = 0.0f;
    for (std::size_t i = 0; i < N; ++i) {
      scale[i] = i > 0 && ratio[i] == ratio[i - 1]
                     ? scale[i - 1]
                     : 1.0f / std::max(1e-6f, passing(ratio[i], roughness, coat));
    }
    return {base_(shading.point, shading.wavelengths),
            metallic_(shading.point),
            ratio,
            roughness,
            coat,
            scale,
            mean_base_,
            mean_index_};
  }

 private:
  static float squared(float x) { return x * x; }
  static bool may_be_smooth(const Scalar& roughness) {
    const auto constant = roughness.constant();
    return !constant || squared(*constant) < BoundRoughness::kMin;
  }
  static BoundRoughness facets(const Scalar& roughness, const SurfacePoint& point) {
    const float alpha = squared(roughness(point));
    return {alpha, alpha};
  }

  /// The mean of 1 - E for evenly incident light, dielectric and coat together.
  static float passing(float ratio, const BoundRoughness& roughness, const PartialCoat& coat) {
    const PartialCoat below{1.0f, ratio, roughness};
    if (!coat.there() && roughness.smooth) {
      return 1.0f - static_cast<float>(hemispherical_reflectance(static_cast<double>(ratio)));
    }
    // Gauss-Legendre over x, the square root of the cosine: 2 mu dmu = 4 x^3 dx.
    constexpr std::array<std::pair<float, float>, 5> kNodes{{{0.0469100770f, 0.1184634425f},
                                                             {0.2307653449f, 0.2393143352f},
                                                             {0.5f, 0.2844444444f},
                                                             {0.7692346551f, 0.2393143352f},
                                                             {0.9530899230f, 0.1184634425f}}};
    float sum = 0.0f;
    for (const auto& [x, weight] : kNodes) {
      const float below_passes = 1.0f - below.reflectance(x * x);
      sum += weight * 4.0f * x * x * x * below_passes * (1.0f - coat.reflectance(x * x));
    }
    return sum;
  }

  Colour base_;
  Scalar metallic_, roughness_;
  Spectrum index_;
  ClearCoat coat_;
  float mean_base_, mean_index_;
};

}  // namespace nocturne

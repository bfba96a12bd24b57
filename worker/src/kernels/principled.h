// The principled surface that exchange formats have in common: a diffuse base under a dielectric,
// or metal, or something between the two, a clear coat over both, and fuzz over all. After B.
// Burley, "Physically-Based Shading at Disney", SIGGRAPH 2012 course, and the OpenPBR surface 1.1,
// with these parts, in one long file as each takes from the parts below it:
//   metal       GGX facets, Schlick's reflectance F = base + (1 - base) (1 - cos)^5
//   dielectric  GGX facets of the same alpha, Fresnel's reflectance of the index; or one that is
//               given at normal incidence, f0, and rises to `amount` with the same curve:
//               amount (f0 + (1 - f0) (F - F0) / (1 - F0)), F0 that of the index
//   base        (base / pi) (1 - E(wo)) (1 - E(wi)) / mean(1 - E), E what dielectric and coat
//               reflect (C. Kelemen and L. Szirmay-Kalos, Eurographics 2001 short papers,
//               section 2.1): so that E + (1 - E) base leaves
//   coat        GGX facets with a separate alpha and index; the parts below get 1 less the
//               larger of what the coat reflects of wo and of wi; its index is taken against vacuum
//   sheen       fibres that stand up (sheen.h); the parts below get 1 less the larger of
//               their reflectances of wo and of wi
// Light that bounces between facets of metal is kept (ggx_energy.h), that of dielectrics goes
// below. Alpha is the square of roughness; brushed facets have two, and an angle to the tangent.
// Each part is reciprocal. No subsurface scattering; transmission is another kernel's.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "kernels/brushed_energy.h"
#include "kernels/fresnel.h"
#include "kernels/ggx_energy.h"
#include "kernels/kernel.h"
#include "kernels/mueller.h"
#include "kernels/rough_fresnel.h"
#include "kernels/roughness.h"
#include "kernels/sheen.h"
#include "math/functions.h"
#include "parameters/colour.h"
#include "spectrum/spectrum.h"

namespace nocturne {

/// A boundary of facets for one wavelength, and how much of it is there.
struct PartialCoat {
  float amount, ratio;
  BoundRoughness roughness;

  bool there() const { return amount > 0.0f; }
  /// The part of light from w that it reflects.
  float reflectance(Vec3 w) const {
    if (!there()) return 0.0f;
    if (roughness.smooth) {
      return amount *
             static_cast<float>(fresnel_dielectric<double>(
                 static_cast<double>(std::clamp(w.z, 0.0f, 1.0f)), static_cast<double>(ratio)));
    }
    // At the first facet, of which a part is shadowed: that goes below.
    const float alpha = roughness.facets.alpha_u;
    if (roughness.brushed()) {
      // By Schlick's approximation, a little more than Fresnel's at grazing angles.
      const float f0 = (ratio - 1.0f) / (ratio + 1.0f) * (ratio - 1.0f) / (ratio + 1.0f);
      return amount * (f0 * BrushedEnergy::reflected(roughness, w) +
                       (1.0f - f0) * BrushedEnergy::grazing(roughness, w));
    }
    return amount * RoughFresnel::instance().reflectance(w.z, alpha, ratio) *
           GgxEnergy::instance().reflected(w.z, alpha);
  }
  /// The same if its facets reflected everything.
  float white(Vec3 w) const {
    if (roughness.smooth) return amount;
    return amount * BrushedEnergy::reflected(roughness, w);
  }
};

/// A dielectric's reflectance where it is not that of its index: even + scale F.
template <class T>
struct Recoloured {
  T even, scale;

  /// f0 at normal incidence, where the index has `own`, rising to `amount`.
  static Recoloured from(const T& f0, const T& own, float amount) {
    const T scale = (T(1.0f) - f0) / (T(1.0f) - own);
    return {amount * (f0 - scale * own), amount * scale};
  }
};

/// Facets along a brush that is turned against the tangent.
struct Turn {
  float cosine = 1.0f, sine = 0.0f;

  Vec3 in(Vec3 w) const {
    if (sine == 0.0f && cosine == 1.0f) return w;
    return {cosine * w.x + sine * w.y, cosine * w.y - sine * w.x, w.z};
  }
  Vec3 out(Vec3 w) const { return Turn{cosine, -sine}.in(w); }
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
  // The rest most surfaces do without.
  bool recoloured = false;
  Recoloured<Spectral<N>> colouring = {0.0f, 1.0f};
  Recoloured<float> mean_colouring = {0.0f, 1.0f};
  BoundSheen<N> sheen = {};
  Turn turn = {};

  Spectral<N> albedo(Vec3 out) const {
    const Vec3 wo = turn.in(out);
    const float coated = coat.reflectance(wo), schlick = schlick_weight(wo.z);
    const Spectral<N> below = each(
        [&](float b, float e) {
          const float under =
              metallic * (b + (1.0f - b) * schlick) + (1.0f - metallic) * (e + (1.0f - e) * b);
          return std::min(1.0f, coated + (1.0f - coated) * under);
        },
        base, dielectric(wo));
    if (!sheen.there()) return below;
    const Spectral<N> fuzz = sheen.reflectance(wo.z);
    return fuzz + (Spectral<N>(1.0f) - fuzz) * below;
  }

  Evaluation<N> evaluate(Vec3 out, Vec3 in) const {
    if (in.z <= 0.0f) return Evaluation<N>::nothing();
    const Vec3 wo = turn.in(out), wi = turn.in(in);
    const Vec3 h = half_vector(wo, wi);
    const float facing = std::clamp(dot(wo, h), 0.0f, 1.0f);
    const float coat_out = coat.reflectance(wo), coat_in = coat.reflectance(wi);
    const Choice choice = choose(wo, coat_out);
    float p = choice.diffuse() * CosineHemisphere::pdf(wi);
    const float through = 1.0f - std::max(coat_out, coat_in);
    Spectral<N> r = diffuse(wo, wi, coat_out, coat_in);
    if (!roughness.smooth) {
      const Facets& facets = roughness.facets;
      const float mirrored = facets.reflection_pdf(wo, h);
      const float once = mirrored * facets.reflection_weight(wo, wi);
      r += through * once * facet_reflectance(facing);
      r += through * many_bounces(wo, wi);
      p += choice.facets * mirrored;
    }
    if (coat.there() && !coat.roughness.smooth) {
      const Facets& facets = coat.roughness.facets;
      const auto fresnel = static_cast<float>(
          fresnel_dielectric<double>(static_cast<double>(facing), static_cast<double>(coat.ratio)));
      const float mirrored = facets.reflection_pdf(wo, h);
      r += Spectral<N>(coat.amount * mirrored * facets.reflection_weight(wo, wi) * fresnel);
      p += choice.coat * mirrored;
    }
    if (sheen.there()) r = r * sheen.through(wo.z, wi.z) + sheen.value(wo, wi, h);
    return {r, p};
  }
  Spectral<N> value(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).value; }
  Spectral<N> pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }

  std::optional<Draw<N>> sample(Vec3 out, const KernelNumbers& numbers, std::size_t) const {
    const Vec3 wo = turn.in(out);
    const float coated = coat.reflectance(wo);
    const Choice choice = choose(wo, coated);
    if (numbers.part < choice.coat) {
      if (coat.roughness.smooth) {
        return mirrored(out, coated / choice.coat);
      }
      return off_facets(wo, coat.roughness.facets, numbers);
    }
    if (numbers.part < choice.coat + choice.facets) {
      if (roughness.smooth) {
        const float share = (1.0f - coated) / choice.facets;
        return mirrored(out, share * facet_reflectance(wo.z));
      }
      return off_facets(wo, roughness.facets, numbers);
    }
    return Draw<N>{.wi = CosineHemisphere::sample(numbers.u, numbers.v)};
  }

  bool smooth() const {
    return !roughness.smooth || metallic < 1.0f || (coat.there() && !coat.roughness.smooth) ||
           sheen.there();
  }
  static constexpr bool transmits() { return false; }

  /// Coat and dielectric mirror as Fresnel's amplitudes of their indices say. The other parts have
  /// none, and depolarise: metal, whose reflectance is a colour, a dielectric's that is given, base
  /// and sheen.
  Mueller<N> mueller(Vec3 out, Vec3 in, std::uint32_t photons) const {
    if (in.z <= 0.0f) return {};
    const Vec3 wo = turn.in(out), wi = turn.in(in), h = half_vector(wo, wi);
    const float facing = std::clamp(dot(wo, h), 0.0f, 1.0f);
    const Spectral<N> past_sheen = sheen.there() ? sheen.through(wo.z, wi.z) : Spectral<N>(1.0f);
    const auto off = [&](const Facets& facets) {
      return facets.reflection_pdf(wo, h) * facets.reflection_weight(wo, wi);
    };
    MuellerSum<N> parts;
    Spectral<N> rest = value(out, in);
    const auto add = [&](const Spectral<N>& part, const Spectral<N>& index) {
      parts.add(past_sheen * part, dielectric_mirror<N>(facing, index, photons));
      rest = rest - past_sheen * part;
    };
    if (!roughness.smooth) {
      const float through = 1.0f - std::max(coat.reflectance(wo), coat.reflectance(wi));
      add(through * off(roughness.facets) * by_amplitudes(facing), ratio);
    }
    if (coat.there() && !coat.roughness.smooth) {
      add(coat.amount * off(coat.roughness.facets) * boundary_reflectance(facing, coat.ratio),
          coat.ratio);
    }
    parts.add(each([](float x) { return std::max(0.0f, x); }, rest), {});
    return parts.mean();
  }
  /// Of both mirrors together, whichever drew.
  Mueller<N> mueller_of_delta(Vec3 out, const Draw<N>&, std::uint32_t photons) const {
    const Vec3 wo = turn.in(out);
    const float coated = coat.reflectance(wo);
    MuellerSum<N> parts;
    if (coat.there() && coat.roughness.smooth) {
      parts.add(coated, dielectric_mirror<N>(wo.z, coat.ratio, photons));
    }
    if (roughness.smooth) {
      const Spectral<N> clear = by_amplitudes(wo.z), all = facet_reflectance(wo.z);
      parts.add((1.0f - coated) * clear, dielectric_mirror<N>(wo.z, ratio, photons));
      parts.add((1.0f - coated) *
                    each([](float a, float b) { return std::max(0.0f, a - b); }, all, clear),
                {});
    }
    return parts.mean();
  }

 private:
  /// Probabilities of the parts; the same for all wavelengths.
  struct Choice {
    float coat, facets;
    float diffuse() const { return std::max(0.0f, 1.0f - coat - facets); }
  };

  /// Whether anything is evenly spread: the base, what bounces between facets, or fuzz.
  bool spreads() const { return metallic < 1.0f || !roughness.smooth || sheen.there(); }

  Choice choose(Vec3 wo, float coated) const {
    // No part is left out: at some wavelength the average may be far off.
    constexpr float kMin = 1.0f / 16.0f;
    const float left = 1.0f - coated;
    const PartialCoat layer = boundary(mean_ratio);
    float e = layer.reflectance(wo);
    if (recoloured) e = mean_colouring.even * layer.white(wo) + mean_colouring.scale * e;
    const float metal = mean_base + (1.0f - mean_base) * schlick_weight(wo.z);
    const float shiny = left * (metallic * metal + (1.0f - metallic) * e);
    float spread = left * (1.0f - metallic) * (1.0f - e) * mean_base;
    if (sheen.there()) spread += sheen.mean_reflectance(wo.z);
    const float total = std::max(1e-6f, coated + shiny + spread);
    Choice choice{coat.there() ? std::max(kMin, coated / total) : 0.0f,
                  std::max(kMin, shiny / total)};
    const float diffuse = spreads() ? std::max(kMin, spread / total) : 0.0f;
    const float sum = choice.coat + choice.facets + diffuse;
    choice.coat /= sum;
    choice.facets = diffuse > 0.0f ? choice.facets / sum : 1.0f - choice.coat;
    return choice;
  }

  Draw<N> mirrored(Vec3 wo, const Spectral<N>& factor) const {
    return {.wi = {-wo.x, -wo.y, wo.z},
            .delta = true,
            .factor = sheen.there() ? factor * sheen.through(wo.z, wo.z) : factor};
  }

  std::optional<Draw<N>> off_facets(Vec3 wo, const Facets& facets,
                                    const KernelNumbers& numbers) const {
    const Vec3 wi = normalized(reflected(wo, facets.sample_visible(wo, numbers.u, numbers.v)));
    if (wi.z <= 0.0f) return std::nullopt;
    return Draw<N>{.wi = turn.out(wi)};
  }

  PartialCoat boundary(float n) const { return {1.0f, n, roughness}; }

  /// E of the dielectric alone.
  Spectral<N> dielectric(Vec3 w) const {
    const Spectral<N> e = each_distinct([&](float n) { return boundary(n).reflectance(w); }, ratio);
    if (!recoloured) return e;
    return boundary(1.0f).white(w) * colouring.even + colouring.scale * e;
  }

  static Spectral<N> boundary_reflectance(float cosine, const Spectral<N>& index) {
    return each_distinct(
        [&](float n) {
          return static_cast<float>(
              fresnel_dielectric<double>(static_cast<double>(cosine), static_cast<double>(n)));
        },
        index);
  }
  /// What a facet's dielectric reflects, where that follows from its index.
  Spectral<N> by_amplitudes(float cosine) const {
    if (recoloured || metallic >= 1.0f) return 0.0f;
    return (1.0f - metallic) * boundary_reflectance(cosine, ratio);
  }

  Spectral<N> facet_reflectance(float cosine) const {
    const float schlick = schlick_weight(cosine);
    const Spectral<N> metal = each([&](float b) { return b + (1.0f - b) * schlick; }, base);
    if (metallic >= 1.0f) return metal;
    Spectral<N> clear = each_distinct(
        [&](float n) {
          return static_cast<float>(
              fresnel_dielectric<double>(static_cast<double>(cosine), static_cast<double>(n)));
        },
        ratio);
    if (recoloured) clear = colouring.even + colouring.scale * clear;
    return metallic * metal + (1.0f - metallic) * clear;
  }

  Spectral<N> diffuse(Vec3 wo, Vec3 wi, float coat_out, float coat_in) const {
    if (metallic >= 1.0f) return 0.0f;
    const float cosine = (1.0f - metallic) * kInvPi * wi.z * (1.0f - coat_out) * (1.0f - coat_in);
    return cosine * diffuse_scale *
           each([](float b, float o, float i) { return b * (1.0f - o) * (1.0f - i); }, base,
                dielectric(wo), dielectric(wi));
  }

  /// What leaves metal after several bounces between facets; of a dielectric it goes to the base.
  Spectral<N> many_bounces(Vec3 wo, Vec3 wi) const {
    if (metallic <= 0.0f) return 0.0f;
    const float mean = BrushedEnergy::mean(roughness);
    const float lost = (1.0f - BrushedEnergy::reflected(roughness, wo)) *
                       (1.0f - BrushedEnergy::reflected(roughness, wi)) /
                       std::max(1e-6f, 1.0f - mean);
    // Schlick's mean over evenly incident light.
    return metallic * lost * kInvPi * wi.z *
           each([&](float b) { return GgxEnergy::left(b + (1.0f - b) / 21.0f, mean); }, base);
  }
};
static_assert(BoundKernel<BoundPrincipled<1>, 1> && BoundKernel<BoundPrincipled<4>, 4>);

class Principled {
 public:
  struct ClearCoat {
    /// In [0, 1]; alpha is the square of roughness.
    Scalar amount, roughness;
    float index;
  };
  /// Of the dielectric, where it is not that of its index.
  struct Reflectance {
    /// At grazing angles; in [0, 1].
    Scalar amount;
    /// At normal incidence, in [0, 1], before `amount`; by default that of the index.
    std::optional<Colour> normal;
  };
  /// Facets that are not the same all around.
  struct Brush {
    /// Across the brush, in [0, 1]; the other is along it.
    Scalar roughness;
    /// From the tangent to the brush, in whole turns.
    Scalar rotation;
  };
  struct Fuzz {
    /// In [0, 1].
    Colour colour;
    Scalar roughness;
  };
  struct Extras {
    std::optional<Reflectance> reflectance = {};
    std::optional<Brush> brush = {};
    std::optional<Fuzz> sheen = {};
  };

  /// Base in [0, 1]; metallic and roughness in [0, 1]; index against vacuum.
  Principled(Colour base, Scalar metallic, Scalar roughness, Spectrum index, ClearCoat coat)
      : Principled(std::move(base), std::move(metallic), std::move(roughness), std::move(index),
                   std::move(coat), Extras{}) {}
  Principled(Colour base, Scalar metallic, Scalar roughness, Spectrum index, ClearCoat coat,
             Extras extras)
      : base_(std::move(base)),
        metallic_(std::move(metallic)),
        roughness_(std::move(roughness)),
        index_(std::move(index)),
        coat_(std::move(coat)),
        extras_(std::move(extras)),
        mean_base_(base_.mean()),
        mean_index_(index_.mean()),
        mean_normal_(extras_.reflectance && extras_.reflectance->normal
                         ? extras_.reflectance->normal->mean()
                         : own_reflectance(mean_index_)),
        mean_sheen_(extras_.sheen ? extras_.sheen->colour.mean() : 0.0f) {
    // Made while loading, not while tracing.
    RoughFresnel::instance();
    HemisphericalReflectance::instance();
    GgxEnergy::instance();
    if (extras_.brush) BrushedEnergy::instance();
    if (extras_.sheen) SheenEnergy::instance();
  }

  bool has_delta_lobe() const {
    const auto amount = coat_.amount.constant();
    return (may_be_smooth(roughness_) &&
            (!extras_.brush || may_be_smooth(extras_.brush->roughness))) ||
           ((!amount || *amount > 0.0f) && may_be_smooth(coat_.roughness));
  }
  static constexpr bool may_transmit() { return false; }

  template <int N>
  BoundPrincipled<N> bind(const Shading<N>& shading) const {
    const SurfacePoint& point = shading.point;
    const BoundRoughness roughness =
        extras_.brush
            ? BoundRoughness{squared(roughness_(point)), squared(extras_.brush->roughness(point))}
            : facets(roughness_, point);
    const PartialCoat coat{coat_.amount(point), coat_.index, facets(coat_.roughness, point)};
    BoundPrincipled<N> bound{base_(point, shading.wavelengths),
                             metallic_(point),
                             index_(shading.wavelengths) / shading.index_from,
                             roughness,
                             coat,
                             0.0f,
                             mean_base_,
                             mean_index_};
    if (extras_.reflectance) recolour(*extras_.reflectance, shading, bound);
    if (extras_.sheen) {
      bound.sheen = {extras_.sheen->colour(point, shading.wavelengths), mean_sheen_,
                     squared(extras_.sheen->roughness(point))};
    }
    if (extras_.brush) {
      const float angle = kTwoPi * extras_.brush->rotation(point);
      if (angle != 0.0f) bound.turn = {math::cos(angle), math::sin(angle)};
    }
    const Spectral<N>&ratio = bound.ratio, &even = bound.colouring.even,
          &scale = bound.colouring.scale;
    for (std::size_t i = 0; i < N; ++i) {
      const bool again =
          i > 0 && ratio[i] == ratio[i - 1] && even[i] == even[i - 1] && scale[i] == scale[i - 1];
      bound.diffuse_scale[i] =
          again ? bound.diffuse_scale[i - 1]
                : 1.0f / std::max(1e-6f, passing({1.0f, ratio[i], roughness}, coat,
                                                 {even[i], scale[i]}, bound.recoloured));
    }
    return bound;
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
  /// Of an index ratio, at normal incidence.
  static float own_reflectance(float ratio) { return squared((ratio - 1.0f) / (ratio + 1.0f)); }

  template <int N>
  void recolour(const Reflectance& reflectance, const Shading<N>& shading,
                BoundPrincipled<N>& bound) const {
    const float amount = reflectance.amount(shading.point);
    const Spectral<N> own = each([](float n) { return own_reflectance(n); }, bound.ratio);
    const Spectral<N> f0 =
        reflectance.normal ? (*reflectance.normal)(shading.point, shading.wavelengths) : own;
    bound.recoloured = true;
    bound.colouring = Recoloured<Spectral<N>>::from(f0, own, amount);
    bound.mean_colouring =
        Recoloured<float>::from(mean_normal_, own_reflectance(mean_index_), amount);
  }

  /// The mean of 1 - E for evenly incident light, dielectric and coat together.
  static float passing(const PartialCoat& below, const PartialCoat& coat,
                       const Recoloured<float>& colouring, bool recoloured) {
    const auto coloured = [&](float e, float white) {
      return recoloured ? colouring.even * white + colouring.scale * e : e;
    };
    if (!coat.there() && below.roughness.smooth) {
      return 1.0f - coloured(HemisphericalReflectance::instance()(below.ratio), 1.0f);
    }
    // Gauss-Legendre over x, the square root of the cosine: 2 mu dmu = 4 x^3 dx.
    constexpr std::array<std::pair<float, float>, 5> kNodes{{{0.0469100770f, 0.1184634425f},
                                                             {0.2307653449f, 0.2393143352f},
                                                             {0.5f, 0.2844444444f},
                                                             {0.7692346551f, 0.2393143352f},
                                                             {0.9530899230f, 0.1184634425f}}};
    float sum = 0.0f;
    for (const auto& [x, weight] : kNodes) {
      // Between brush and across: there alpha is the root mean square of both.
      const float mu = x * x, side = std::sqrt(0.5f * (1.0f - mu * mu));
      const Vec3 w{side, side, mu};
      const float below_passes =
          1.0f - coloured(below.reflectance(w), recoloured ? below.white(w) : 0.0f);
      sum += weight * 4.0f * x * x * x * below_passes * (1.0f - coat.reflectance(w));
    }
    return sum;
  }

  Colour base_;
  Scalar metallic_, roughness_;
  Spectrum index_;
  ClearCoat coat_;
  Extras extras_;
  float mean_base_, mean_index_, mean_normal_, mean_sheen_;
};

}  // namespace nocturne

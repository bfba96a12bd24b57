// A dielectric coat, smooth or rough, over a Lambertian base: varnish, plastic, glossy paint. The
// coat mirrors as a dielectric does. What enters is scattered by the base, and evenly distributed
// light bounces between base and coat as often as it likes, which sums to
//   BRDF = (1 - E(wo)) (1 - E(wi)) R / (pi n^2 (1 - R E_in)),  E_in = 1 - (1 - E_out) / n^2,
// E(w) what the coat reflects (Fresnel; of a rough one averaged over its facets, rough_fresnel.h),
// E_out its mean over evenly incident light, n the coat's index over that outside. Closed form of
// Saunderson, JOSA 32(12), 1942; reciprocal, and what leaves is at most what entered. A rough
// coat's approximations: its transmission refracts as a smooth one, and light that bounces between
// facets is lost. E knows one roughness, so of two it is given
//   alpha^2 = (w_x alpha_u)^2 + (w_y alpha_v)^2 + w_z^2 (alpha_u^2 + alpha_v^2) / 2,
// the spread of facets in the plane of w at grazing angles and their mean along the normal; E_out
// takes their root mean square, by which up to 0.3 % of the base's light is lost, never gained.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/fresnel.h"
#include "kernels/kernel.h"
#include "kernels/mueller.h"
#include "kernels/rough_fresnel.h"
#include "kernels/roughness.h"
#include "parameters/colour.h"
#include "spectrum/spectrum.h"

namespace nocturne {

/// The coat for one wavelength: its reflectance, for light from outside.
struct Coat {
  float ratio, alpha;
  bool smooth;

  float reflectance(float cosine) const {
    return smooth ? static_cast<float>(
                        fresnel_dielectric<double>(std::clamp(cosine, 0.0f, 1.0f), ratio))
                  : RoughFresnel::instance().reflectance(cosine, alpha, ratio);
  }
  float hemispherical() const {
    return smooth ? HemisphericalReflectance::instance()(ratio)
                  : RoughFresnel::instance().hemispherical(alpha, ratio);
  }
};

/// R / (n^2 (1 - R E_in)) for a base of reflectance R under a coat that reflects `out` of even
/// light.
inline float diffuse_gain(float reflectance, float ratio, float out) {
  const float leaves = (1.0f - out) / (ratio * ratio);
  const float remains = 1.0f - reflectance + reflectance * leaves;
  return remains > 0.0f ? reflectance / (ratio * ratio * remains) : 0.0f;
}

template <int N>
struct BoundCoatedDiffuse {
  BoundRoughness roughness;
  /// Of the coat against outside.
  Spectral<N> ratio;
  /// R / (n^2 (1 - R E_in)).
  Spectral<N> gain;
  /// R (1 - E_in) / (1 - R E_in): the share of the light that entered which leaves again.
  Spectral<N> leaving;
  /// The coat and the base's share at average wavelengths, for the choice between the two parts.
  float mean_ratio, mean_leaving;

  Spectral<N> albedo(Vec3 wo) const {
    const Spectral<N> e = coat(wo);
    return each([](float r, float out) { return std::min(1.0f, r + (1.0f - r) * out); }, e,
                leaving);
  }

  Evaluation<N> evaluate(Vec3 wo, Vec3 wi) const {
    if (wi.z <= 0.0f) return Evaluation<N>::nothing();
    const float glossy = glossy_probability(wo);
    Spectral<N> r = diffuse(wo, wi);
    float p = (1.0f - glossy) * CosineHemisphere::pdf(wi);
    if (!roughness.smooth) {
      const Vec3 h = half_vector(wo, wi);
      const float mirrored = roughness.facets.reflection_pdf(wo, h);
      r += mirrored * roughness.facets.reflection_weight(wo, wi) * first_facet(dot(wo, h));
      p += glossy * mirrored;
    }
    return {r, p};
  }
  Spectral<N> value(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).value; }
  Spectral<N> pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }

  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t) const {
    const float glossy = glossy_probability(wo);
    if (!(numbers.part < glossy)) {
      return Draw<N>{.wi = CosineHemisphere::sample(numbers.u, numbers.v)};
    }
    if (roughness.smooth) {
      return Draw<N>{
          .wi = {-wo.x, -wo.y, wo.z}, .delta = true, .factor = (1.0f / glossy) * coat(wo)};
    }
    const Vec3 wi =
        normalized(reflected(wo, roughness.facets.sample_visible(wo, numbers.u, numbers.v)));
    if (wi.z <= 0.0f) return std::nullopt;
    return Draw<N>{.wi = wi};
  }

  static constexpr bool smooth() { return true; }
  static constexpr bool transmits() { return false; }

  /// The coat mirrors as Fresnel's amplitudes say; the base depolarises.
  Mueller<N> mueller(Vec3 wo, Vec3 wi, std::uint32_t photons) const {
    if (roughness.smooth || wi.z <= 0.0f) return {};
    const Vec3 h = half_vector(wo, wi);
    const float facing = dot(wo, h);
    MuellerSum<N> parts;
    parts.add(diffuse(wo, wi), {});
    parts.add(roughness.facets.reflection_pdf(wo, h) * roughness.facets.reflection_weight(wo, wi) *
                  first_facet(facing),
              dielectric_mirror<N>(facing, ratio, photons));
    return parts.mean();
  }
  Mueller<N> mueller_of_delta(Vec3 wo, const Draw<N>&, std::uint32_t photons) const {
    return dielectric_mirror<N>(wo.z, ratio, photons);
  }

 private:
  Spectral<N> coat(Vec3 w) const {
    const float alpha = roughness.seen_from(w);
    return each_distinct(
        [&](float n) {
          return Coat{n, alpha, roughness.smooth}.reflectance(w.z);
        },
        ratio);
  }

  Spectral<N> diffuse(Vec3 wo, Vec3 wi) const {
    return each(
        [&](float o, float i, float g) { return (1.0f - o) * (1.0f - i) * g * kInvPi * wi.z; },
        coat(wo), coat(wi), gain);
  }

  Spectral<N> first_facet(float cosine) const {
    const double facing = static_cast<double>(std::clamp(cosine, 0.0f, 1.0f));
    return each_distinct(
        [facing](float n) { return static_cast<float>(fresnel_dielectric<double>(facing, n)); },
        ratio);
  }

  /// Of drawing from the coat's reflection; the same for all wavelengths. Neither part is left out,
  /// since at some wavelength the average may be far off.
  float glossy_probability(Vec3 wo) const {
    constexpr float kMin = 1.0f / 16.0f;
    const float e = Coat{mean_ratio, roughness.seen_from(wo), roughness.smooth}.reflectance(wo.z);
    const float total = e + (1.0f - e) * mean_leaving;
    return std::clamp(total > 0.0f ? e / total : 0.0f, kMin, 1.0f - kMin);
  }
};
static_assert(BoundKernel<BoundCoatedDiffuse<1>, 1> && BoundKernel<BoundCoatedDiffuse<4>, 4>);

class CoatedDiffuse {
 public:
  /// Index against vacuum; reflectance of the base in [0, 1].
  CoatedDiffuse(Spectrum index, Roughness roughness, Colour reflectance)
      : index_(std::move(index)),
        roughness_(std::move(roughness)),
        reflectance_(std::move(reflectance)),
        mean_index_(index_.mean()) {
    const Coat smooth{mean_index_, 0.0f, true};
    const float out = smooth.hemispherical();
    mean_leaving_ = diffuse_gain(reflectance_.mean(), mean_index_, out) * (1.0f - out);
    // Made while loading, not while tracing.
    RoughFresnel::instance();
    HemisphericalReflectance::instance();
  }

  bool has_delta_lobe() const { return roughness_.may_be_smooth(); }
  static constexpr bool may_transmit() { return false; }

  template <int N>
  BoundCoatedDiffuse<N> bind(const Shading<N>& shading) const {
    const BoundRoughness roughness = roughness_(shading.point);
    const float alpha = roughness.seen_from({0.0f, 0.0f, 1.0f});
    const Spectral<N> ratio = index_(shading.wavelengths) / shading.index_from;
    const Spectral<N> base = reflectance_(shading.point, shading.wavelengths);
    const Spectral<N> out = each_distinct(
        [&](float n) {
          return Coat{n, alpha, roughness.smooth}.hemispherical();
        },
        ratio);
    const Spectral<N> gain = each(diffuse_gain, base, ratio, out);
    const Spectral<N> leaving = gain * (Spectral<N>(1.0f) - out);
    return {roughness, ratio, gain, leaving, mean_index_, mean_leaving_};
  }

 private:
  Spectrum index_;
  Roughness roughness_;
  Colour reflectance_;
  float mean_index_, mean_leaving_;
};

}  // namespace nocturne

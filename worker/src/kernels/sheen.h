// Fuzz: fibres that stand up and shine where they are seen from the side, as on velvet. Facets of
// A. Estevez and C. Kulla, "Production Friendly Microfacet Sheen BRDF", SIGGRAPH 2017 course, whose
// normals lie flat (equation 2: D = (2 + 1 / alpha) sin(theta)^(1 / alpha) / (2 pi)), with the
// visibility 1 / (4 (cos o + cos i - cos o cos i)) of D. Neubelt and M. Pettineo, SIGGRAPH 2013
// course: what KHR_materials_sheen of glTF asks for. Where that would reflect more than all light,
// it is divided by its albedo at wo or at wi, whichever is greater.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/kernel.h"
#include "math/constants.h"

namespace nocturne {

/// Directional albedo of white fuzz, in a table over roughness and angle, made once by quadrature
/// (midpoints) and interpolated linearly.
class SheenEnergy {
 public:
  /// A smaller alpha is taken as this.
  static constexpr float kMinAlpha = 0.01f;

  static const SheenEnergy& instance();

  /// May be more than 1.
  float reflected(float cosine, float alpha) const;
  /// BRDF times cosine.
  static float value(Vec3 wo, Vec3 wi, Vec3 h, float alpha);

 private:
  SheenEnergy();

  std::vector<float> reflected_;
};

template <int N>
struct BoundSheen {
  Spectral<N> colour = 0.0f;
  /// Of all wavelengths, for the choice between parts.
  float mean_colour = 0.0f;
  /// 0: there is none.
  float alpha = 0.0f;

  BoundSheen() = default;
  BoundSheen(const Spectral<N>& bound_colour, float mean, float roughness_alpha)
      : colour(bound_colour),
        mean_colour(mean),
        alpha(std::max(SheenEnergy::kMinAlpha, roughness_alpha)) {}

  bool there() const { return alpha > 0.0f; }
  Spectral<N> reflectance(float cosine) const { return white(cosine) * colour; }
  float mean_reflectance(float cosine) const { return white(cosine) * mean_colour; }
  /// What gets below and back.
  Spectral<N> through(float cosine_out, float cosine_in) const {
    return Spectral<N>(1.0f) - std::max(white(cosine_out), white(cosine_in)) * colour;
  }
  Spectral<N> value(Vec3 wo, Vec3 wi, Vec3 h) const {
    const SheenEnergy& energy = SheenEnergy::instance();
    const float most =
        std::max({1.0f, energy.reflected(wo.z, alpha), energy.reflected(wi.z, alpha)});
    return SheenEnergy::value(wo, wi, h, alpha) / most * colour;
  }

 private:
  float white(float cosine) const {
    return std::min(1.0f, SheenEnergy::instance().reflected(cosine, alpha));
  }
};

}  // namespace nocturne

// The GGX distribution of microfacet normals, with two roughnesses, and Smith's masking and
// shadowing. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007;
// Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014
// (height-correlated: equation 99). Normals are drawn from those that wo sees, as Dupuy and
// Benyoub, "Sampling Visible GGX Normals with Spherical Caps", Computer Graphics Forum 42(8), 2023.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/constants.h"
#include "math/functions.h"
#include "math/vec3.h"

namespace nocturne {

inline Vec3 reflected(Vec3 w, Vec3 normal) { return 2.0f * dot(w, normal) * normal - w; }

/// Of a, and `scale` b (scale 1: reflection; index ratio: refraction), unit, towards positive z. In
/// double: at grazing angles and for ratios near 1 the sum is a small difference.
Vec3 half_vector(Vec3 a, Vec3 b, double scale = 1.0);

/// B(1 + a, 1 + b) for a, b >= 0: Euler's beta function.
double beta_1p(double a, double b);

struct Ggx {
  /// In [1e-4, 1].
  float alpha_u, alpha_v;

  /// D: microfacet area per unit area of surface and per steradian of normals.
  float density(Vec3 h) const {
    const float x = h.x / alpha_u, y = h.y / alpha_v;
    const float e = x * x + y * y + h.z * h.z;
    return 1.0f / (kPi * alpha_u * alpha_v * e * e);
  }

  /// Length of w in the space where the facets are those of a sphere; Smith's Lambda is
  /// (stretched(w) / |w.z| - 1) / 2.
  float stretched(Vec3 w) const {
    const float x = alpha_u * w.x, y = alpha_v * w.y;
    return std::sqrt(x * x + y * y + w.z * w.z);
  }

  /// A normal among those that wo sees; density `visible(wo, h)`.
  Vec3 sample_visible(Vec3 wo, float u, float v) const {
    const Vec3 w = normalized(Vec3{alpha_u * wo.x, alpha_v * wo.y, wo.z});
    const float lift = (1.0f - u) * (1.0f + w.z);  // in (0, 1 + w.z]: the half vector's height
    const float z = lift - w.z;
    const float r = std::sqrt(std::max(0.0f, (1.0f - z) * (1.0f + z)));
    const float phi = kTwoPi * v;
    return normalized(
        Vec3{alpha_u * (r * math::cos(phi) + w.x), alpha_v * (r * math::sin(phi) + w.y), lift});
  }

  /// D_wo(h), per steradian of normals: G1(wo) (wo . h) D(h) / wo.z, for wo . h >= 0.
  float visible(Vec3 wo, Vec3 h) const {
    return 2.0f * std::max(0.0f, dot(wo, h)) * density(h) / (wo.z + stretched(wo));
  }

  /// Density, per steradian of wi, of mirroring wo at a visible normal; h is their half vector.
  float reflection_pdf(Vec3 wo, Vec3 h) const { return 0.5f * density(h) / (wo.z + stretched(wo)); }

  /// G2 / G1(wo) for both above the surface, in [0, 1]: what a drawn reflection weighs.
  float reflection_weight(Vec3 wo, Vec3 wi) const {
    const float so = stretched(wo), below = wi.z * so + wo.z * stretched(wi);
    return below > 0.0f ? std::min(1.0f, wi.z * (wo.z + so) / below) : 0.0f;
  }

  /// The same for wi below the surface. Heights are shared but seen from opposite sides, so G2 is
  /// the beta function of 1 + Lambda: Heitz et al., "Multiple-Scattering Microfacet BSDFs with the
  /// Smith Model", ACM TOG 35(4), 2016.
  float transmission_weight(Vec3 wo, Vec3 wi) const {
    const double o = lambda(wo), i = lambda(wi);
    return static_cast<float>(std::min(1.0, beta_1p(o, i) * (1.0 + o)));
  }

 private:
  double lambda(Vec3 w) const {
    const double z = std::max(1e-30, std::fabs(static_cast<double>(w.z)));
    return std::max(0.0, 0.5 * (static_cast<double>(stretched(w)) / z - 1.0));
  }
};

}  // namespace nocturne

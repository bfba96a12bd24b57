// The Beckmann distribution of microfacet normals, whose slopes are normally distributed, with two
// roughnesses, and Smith's masking and shadowing. Walter et al., "Microfacet Models for Refraction
// through Rough Surfaces", EGSR 2007, equations 25 to 28 (the exact form with erf); Heitz, JCGT
// 3(2), 2014, equations 67, 72 and 99. Normals are drawn from those that wo sees, slope by slope:
// Heitz and d'Eon, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible
// Normals", Computer Graphics Forum 33(4), 2014.
#pragma once

#include "math/vec3.h"

namespace nocturne {

/// The same functions as Ggx has.
struct Beckmann {
  /// In [1e-4, 1]; sqrt 2 times the standard deviation of the slopes.
  float alpha_u, alpha_v;

  float density(Vec3 h) const;
  Vec3 sample_visible(Vec3 wo, float u, float v) const;
  float visible(Vec3 wo, Vec3 h) const;
  float reflection_pdf(Vec3 wo, Vec3 h) const;
  float reflection_weight(Vec3 wo, Vec3 wi) const;
  float transmission_weight(Vec3 wo, Vec3 wi) const;
};

}  // namespace nocturne

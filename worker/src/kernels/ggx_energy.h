// What GGX facets that reflect everything send back after one reflection: the rest bounces on
// between facets. C. Kulla and A. Conty, "Revisiting Physically Based Shading at Imageworks",
// SIGGRAPH 2017 course, send it out by a reciprocal lobe,
//   (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_mean)),
// times what the bounces leave of it: F^2 E_mean / (1 - F (1 - E_mean)), F the facets' mean
// reflectance (their slide 17; of F^2 one is that of the first bounce).
#pragma once

#include <vector>

namespace nocturne {

/// A table over cosine and roughness, made once by quadrature over visible normals (midpoints,
/// 16 x 16) and interpolated linearly.
class GgxEnergy {
 public:
  static const GgxEnergy& instance();

  /// E, in [0, 1]; alpha within [0, 1].
  float reflected(float cosine, float alpha) const;
  /// Its mean for light that comes evenly from all directions, of the interpolated values.
  float mean(float alpha) const;

  /// What the bounces leave of light, for facets of a mean reflectance.
  static float left(float reflectance, float mean) {
    return reflectance * reflectance * mean / (1.0f - reflectance * (1.0f - mean));
  }

 private:
  GgxEnergy();

  std::vector<float> reflected_, mean_;
};

}  // namespace nocturne

// What a rough dielectric boundary reflects at the first facet that light meets: Fresnel's
// reflectance averaged over the GGX normals that wo sees. At least what single scattering off the
// facets sends back, since masking and shadowing only take from it.
#pragma once

#include <vector>

namespace nocturne {

/// Two tables over roughness and index ratio, the second also over angle, made once by quadrature
/// over visible normals (midpoints, 12 x 12) and interpolated linearly. They hold the difference to
/// the smooth boundary, which Fresnel's equations give exactly.
class RoughFresnel {
 public:
  static const RoughFresnel& instance();

  /// In [0, 1]. `ratio` is held within [1/2, 4], alpha within [0, 1].
  float reflectance(float cosine, float alpha, float ratio) const;
  /// Its mean for light that comes evenly from all directions: exactly that of the interpolated
  /// values.
  float hemispherical(float alpha, float ratio) const;

 private:
  RoughFresnel();

  std::vector<float> difference_, mean_difference_;
};

}  // namespace nocturne

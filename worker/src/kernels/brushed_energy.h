// What GGX facets of two alphas that reflect everything send back after one reflection, as
// ggx_energy.h has it for those of one.
#pragma once

#include <algorithm>
#include <vector>

#include "kernels/roughness.h"

namespace nocturne {

/// Schlick's (1 - cos)^5.
inline float schlick_weight(float cosine) {
  const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f), m2 = m * m;
  return m2 * m2 * m;
}

/// A table over both alphas, cosine and azimuth, made once by quadrature over visible normals
/// (midpoints, 16 x 16) and interpolated linearly. Facets of one alpha are looked up in GgxEnergy.
class BrushedEnergy {
 public:
  static const BrushedEnergy& instance();

  /// E, in [0, 1], of light from w.
  static float reflected(const BoundRoughness& roughness, Vec3 w);
  /// The same of facets that reflect (1 - cos)^5 of what meets them, Schlick's weight; brushed ones
  /// alone.
  static float grazing(const BoundRoughness& roughness, Vec3 w);
  /// E's mean for light that comes evenly from all directions.
  static float mean(const BoundRoughness& roughness);

 private:
  BrushedEnergy();

  float at(const std::vector<float>& table, const Facets& facets, Vec3 w) const;

  std::vector<float> reflected_, grazing_, mean_;
};

}  // namespace nocturne

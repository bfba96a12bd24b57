// Roughness of a surface of microfacets, along and across the tangent.
#pragma once

#include <algorithm>

#include "kernels/facets.h"
#include "parameters/scalar.h"

namespace nocturne {

/// Alphas at a point, or smooth.
struct BoundRoughness {
  /// Below it facets deviate by less than a hundredth of a degree: both below are smooth, and one
  /// below is raised to it, which keeps single precision well-conditioned.
  static constexpr float kMin = 1e-4f;

  bool smooth;
  Facets facets;

  BoundRoughness(float alpha_u, float alpha_v,
                 FacetDistribution distribution = FacetDistribution::kGgx)
      : smooth(std::max(alpha_u, alpha_v) < kMin),
        facets{std::clamp(alpha_u, kMin, 1.0f), std::clamp(alpha_v, kMin, 1.0f), distribution} {}

  /// One alpha for both, as they are met from w: along the normal their root mean square, at
  /// grazing angles the alpha in the plane of w and the normal.
  float seen_from(Vec3 w) const {
    const float u2 = facets.alpha_u * facets.alpha_u, v2 = facets.alpha_v * facets.alpha_v;
    return std::sqrt(w.x * w.x * u2 + w.y * w.y * v2 + w.z * w.z * 0.5f * (u2 + v2));
  }
  /// Whether there is a direction along which it is less than across.
  bool brushed() const { return facets.alpha_u != facets.alpha_v; }
};

/// Alphas in [0, 1].
struct Roughness {
  Scalar alpha_u, alpha_v;
  FacetDistribution distribution = FacetDistribution::kGgx;

  /// A texture may hold anything.
  bool may_be_smooth() const {
    const auto u = alpha_u.constant(), v = alpha_v.constant();
    return !u || !v || std::max(*u, *v) < BoundRoughness::kMin;
  }

  BoundRoughness operator()(const SurfacePoint& point) const {
    return {alpha_u(point), alpha_v(point), distribution};
  }
};

}  // namespace nocturne

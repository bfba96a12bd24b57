// What tables over roughness and angle are filled by: means over GGX facets, made once.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "kernels/ggx.h"

namespace nocturne {

/// f(wo, normal) for count x count of the facets' normals that `wo`, at a cosine to the surface's
/// normal, sees: midpoints over half a circle, for `wo` lies in the plane y = 0.
template <class F>
void for_each_visible_normal(double cosine, float alpha, int count, const F& f) {
  const Ggx ggx{alpha, alpha};
  const Vec3 wo{static_cast<float>(std::sqrt((1.0 - cosine) * (1.0 + cosine))), 0.0f,
                static_cast<float>(cosine)};
  const auto midpoint = [&](int i) {
    return (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
  };
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      f(wo, ggx.sample_visible(wo, midpoint(i), 0.5f * midpoint(j)));
    }
  }
}

/// Mean of f over these.
template <class F>
double mean_over_visible_normals(double cosine, float alpha, int count, const F& f) {
  double sum = 0.0;
  for_each_visible_normal(cosine, alpha, count, [&](Vec3 wo, Vec3 h) { sum += f(wo, h); });
  return sum / (count * count);
}

/// 2 x the integral of e(mu) mu dmu over [0, 1], from values at cosines mu = x^2 with x equally
/// spaced: 4 e(x) x^3 dx, e linear in each cell.
inline double cosine_weighted_mean(std::span<const float> values) {
  const auto cells = static_cast<double>(values.size() - 1);
  double mean = 0.0;
  for (std::size_t c = 0; c + 1 < values.size(); ++c) {
    const double x0 = static_cast<double>(c) / cells;
    const double x1 = static_cast<double>(c + 1) / cells;
    const double slope =
        (static_cast<double>(values[c + 1]) - static_cast<double>(values[c])) / (x1 - x0);
    const double base = static_cast<double>(values[c]) - slope * x0;
    const double fourth0 = x0 * x0 * x0 * x0, fourth1 = x1 * x1 * x1 * x1;
    mean += base * (fourth1 - fourth0) + slope * 0.8 * (fourth1 * x1 - fourth0 * x0);
  }
  return mean;
}

}  // namespace nocturne

#include "kernels/fresnel.h"

#include <algorithm>
#include <cmath>

#include "math/functions.h"

namespace nocturne {
namespace {

// From the thinner side, n > 1. Terms cancel near 1: the error is that of double, over (n - 1)^2.
double closed_form(double n) {
  const double n2 = n * n, n4 = n2 * n2, sum = n2 + 1, difference = (n - 1) * (n + 1) * sum;
  const double r = 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
                   n2 * (n2 - 1) * (n2 - 1) / (sum * sum * sum) * math::log((n - 1) / (n + 1)) -
                   2 * n * n2 * (n2 + 2 * n - 1) / (sum * difference) +
                   8 * n4 * (n4 + 1) / (sum * difference * difference) * math::log(n);
  return std::clamp(r, 0.0, 1.0);
}

// The same where nothing cancels. With d = n^2 - 1 the cosine outside is sqrt(d) sinh(x), n times
// that inside sqrt(d) cosh(x). Across the plane of incidence the reflectance is then e^(-4 x), with
// a closed integral; in it ((d sinh(x) - e^(-x)) / (d sinh(x) + e^x))^2, by five nodes of Gauss in
// each panel.
double near_one(double n) {
  constexpr int kPanels = 16;
  const double d = (n - 1.0) * (n + 1.0), sum = (n + 1.0) * (n + 1.0);
  const double across = d / 6.0 - d * d / (4.0 * sum) + d * d * d * d / (12.0 * sum * sum * sum);
  const double root = 2.0 * std::sqrt(10.0 / 7.0), inner = std::sqrt(5.0 - root) / 3.0,
               outer = std::sqrt(5.0 + root) / 3.0;
  const double share = 13.0 * std::sqrt(70.0);
  const double nodes[5][2] = {{0.0, 128.0 / 225.0},
                              {inner, (322.0 + share) / 900.0},
                              {-inner, (322.0 + share) / 900.0},
                              {outer, (322.0 - share) / 900.0},
                              {-outer, (322.0 - share) / 900.0}};
  const double half = 0.5 * math::asinh(1.0 / std::sqrt(d)) / kPanels;
  double along = 0.0;
  for (int panel = 0; panel < kPanels; ++panel) {
    for (const auto& [place, weight] : nodes) {
      const double power = math::exp(half * (2 * panel + 1 + place)), less = 1.0 / power;
      const double sinh = 0.5 * (power - less), cosh = 0.5 * (power + less);
      const double ratio = (d * sinh - less) / (d * sinh + power);
      along += weight * half * 2.0 * d * sinh * cosh * ratio * ratio;
    }
  }
  return 0.5 * (across + along);
}

double from_thinner_side(double n) {
  if (n > 1.01) return closed_form(n);
  if (n > 1.0 + 1e-12) return near_one(n);
  // The first term of the series.
  return (n - 1.0) / 3.0;
}

}  // namespace

double hemispherical_reflectance(double ratio) {
  if (ratio == 1.0) return 0.0;
  if (ratio > 1.0) return from_thinner_side(ratio);
  // 1 - (1 - R) / n^2, n = 1 / ratio
  return (1.0 - ratio) * (1.0 + ratio) + from_thinner_side(1.0 / ratio) * ratio * ratio;
}

const HemisphericalReflectance& HemisphericalReflectance::instance() {
  static const HemisphericalReflectance table;
  return table;
}

HemisphericalReflectance::HemisphericalReflectance() {
  for (std::size_t i = 0; i <= kCells; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(kCellsPerT);
    values_[i] = static_cast<float>(hemispherical_reflectance(1.0 + t * t));
  }
}

float HemisphericalReflectance::from_thinner_side(float n) const {
  if (!(n < kMaxRatio)) return static_cast<float>(hemispherical_reflectance(n));
  const float place = std::sqrt(n - 1.0f) * kCellsPerT;
  const auto cell = std::min(static_cast<std::size_t>(place), kCells - 1);
  const float t = place - static_cast<float>(cell);
  return values_[cell] + t * (values_[cell + 1] - values_[cell]);
}

float HemisphericalReflectance::operator()(float ratio) const {
  if (ratio >= 1.0f) return from_thinner_side(ratio);
  return (1.0f - ratio) * (1.0f + ratio) + from_thinner_side(1.0f / ratio) * ratio * ratio;
}

}  // namespace nocturne

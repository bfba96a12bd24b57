#include "kernels/rough_fresnel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "kernels/fresnel.h"
#include "kernels/table_cell.h"
#include "kernels/table_quadrature.h"
#include "math/functions.h"

namespace nocturne {
namespace {

// Nodes: the square roots of alpha and of the cosine equally spaced in [0, 1], so that they are
// close together where little roughness meets grazing angles; log2 of the ratio in [-1, 2] in steps
// of 1/16, with a node at ratio 1.
constexpr std::size_t kAlphas = 17, kCosines = 25, kRatios = 49;
constexpr float kRatiosPerOctave = 16.0f;
constexpr int kNormals = 12;

std::size_t place(std::size_t ratio, std::size_t alpha) { return ratio * kAlphas + alpha; }

// Of each ratio; the facets are the same for all of them.
std::array<double, kRatios> ratios() {
  std::array<double, kRatios> each;
  for (std::size_t r = 0; r < kRatios; ++r) {
    each[r] = math::exp2(static_cast<double>(r) / kRatiosPerOctave - 1.0);
  }
  return each;
}
std::array<double, kRatios> averages(double cosine, float alpha,
                                     const std::array<double, kRatios>& of) {
  std::array<double, kRatios> sums{};
  for_each_visible_normal(cosine, alpha, kNormals, [&](Vec3 wo, Vec3 h) {
    const auto to_facet = static_cast<double>(std::clamp(dot(wo, h), 0.0f, 1.0f));
    for (std::size_t r = 0; r < kRatios; ++r) sums[r] += fresnel_dielectric(to_facet, of[r]);
  });
  for (double& sum : sums) sum /= kNormals * kNormals;
  return sums;
}

struct TableCell {
  TablePlace ratio, alpha;
  TableCell(float alpha_value, float ratio_value)
      : ratio(table_place((math::log2(ratio_value) + 1.0f) * kRatiosPerOctave, kRatios)),
        alpha(table_place(std::sqrt(alpha_value) * static_cast<float>(kAlphas - 1), kAlphas)) {}

  template <class F>
  float interpolate(const F& at) const {
    const auto along = [&](std::size_t r) {
      return mix(at(place(r, alpha.index)), at(place(r, alpha.index + 1)), alpha.t);
    };
    return mix(along(ratio.index), along(ratio.index + 1), ratio.t);
  }
};

}  // namespace

const RoughFresnel& RoughFresnel::instance() {
  static const RoughFresnel tables;
  return tables;
}

RoughFresnel::RoughFresnel()
    : difference_(kRatios * kAlphas * kCosines), mean_difference_(kRatios * kAlphas) {
  const std::array<double, kRatios> ratio = ratios();
  for (std::size_t a = 1; a < kAlphas; ++a) {
    const float root_alpha = static_cast<float>(a) / static_cast<float>(kAlphas - 1);
    for (std::size_t c = 0; c < kCosines; ++c) {
      const double root = static_cast<double>(c) / static_cast<double>(kCosines - 1);
      const double cosine = std::max(1e-6, root * root);
      const auto rough = averages(cosine, root_alpha * root_alpha, ratio);
      for (std::size_t r = 0; r < kRatios; ++r) {
        difference_[place(r, a) * kCosines + c] =
            static_cast<float>(rough[r] - fresnel_dielectric(cosine, ratio[r]));
      }
    }
    for (std::size_t r = 0; r < kRatios; ++r) {
      const float* row = &difference_[place(r, a) * kCosines];
      mean_difference_[place(r, a)] = static_cast<float>(cosine_weighted_mean({row, kCosines}));
    }
  }
}

float RoughFresnel::reflectance(float cosine, float alpha, float ratio) const {
  const TablePlace c =
      table_place(std::sqrt(std::max(0.0f, cosine)) * static_cast<float>(kCosines - 1), kCosines);
  const float difference = TableCell(alpha, ratio).interpolate([&](std::size_t p) {
    const float* row = &difference_[p * kCosines];
    return mix(row[c.index], row[c.index + 1], c.t);
  });
  const auto exact =
      static_cast<float>(fresnel_dielectric<double>(std::clamp(cosine, 0.0f, 1.0f), ratio));
  return std::clamp(exact + difference, 0.0f, 1.0f);
}

float RoughFresnel::hemispherical(float alpha, float ratio) const {
  const float difference =
      TableCell(alpha, ratio).interpolate([&](std::size_t p) { return mean_difference_[p]; });
  return std::clamp(HemisphericalReflectance::instance()(ratio) + difference, 0.0f, 1.0f);
}

}  // namespace nocturne

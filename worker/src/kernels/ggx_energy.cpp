#include "kernels/ggx_energy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "kernels/ggx.h"
#include "kernels/table_cell.h"
#include "kernels/table_quadrature.h"

namespace nocturne {
namespace {

// Square roots of alpha and of the cosine, equally spaced in [0, 1], as in rough_fresnel.cpp.
constexpr std::size_t kAlphas = 17, kCosines = 33;
constexpr int kNormals = 16;

double single(double cosine, float alpha) {
  const Ggx ggx{alpha, alpha};
  return mean_over_visible_normals(cosine, alpha, kNormals, [&](Vec3 wo, Vec3 h) {
    const Vec3 wi = reflected(wo, h);
    return wi.z > 0.0f ? static_cast<double>(ggx.reflection_weight(wo, wi)) : 0.0;
  });
}

}  // namespace

const GgxEnergy& GgxEnergy::instance() {
  static const GgxEnergy table;
  return table;
}

GgxEnergy::GgxEnergy() : reflected_(kAlphas * kCosines, 1.0f), mean_(kAlphas, 1.0f) {
  for (std::size_t a = 1; a < kAlphas; ++a) {
    const float root_alpha = static_cast<float>(a) / static_cast<float>(kAlphas - 1);
    float* row = &reflected_[a * kCosines];
    for (std::size_t c = 0; c < kCosines; ++c) {
      const double root = static_cast<double>(c) / static_cast<double>(kCosines - 1);
      row[c] = static_cast<float>(
          std::min(1.0, single(std::max(1e-6, root * root), root_alpha * root_alpha)));
    }
    mean_[a] = static_cast<float>(cosine_weighted_mean({row, kCosines}));
  }
}

float GgxEnergy::reflected(float cosine, float alpha) const {
  const TablePlace a = table_place(std::sqrt(alpha) * static_cast<float>(kAlphas - 1), kAlphas);
  const TablePlace c =
      table_place(std::sqrt(std::max(0.0f, cosine)) * static_cast<float>(kCosines - 1), kCosines);
  const auto along = [&](std::size_t index) {
    const float* row = &reflected_[index * kCosines];
    return mix(row[c.index], row[c.index + 1], c.t);
  };
  return mix(along(a.index), along(a.index + 1), a.t);
}

float GgxEnergy::mean(float alpha) const {
  const TablePlace a = table_place(std::sqrt(alpha) * static_cast<float>(kAlphas - 1), kAlphas);
  return mix(mean_[a.index], mean_[a.index + 1], a.t);
}

}  // namespace nocturne

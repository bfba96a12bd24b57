#include "kernels/ggx_energy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "kernels/ggx.h"
#include "kernels/table_cell.h"

namespace nocturne {
namespace {

// Square roots of alpha and of the cosine, equally spaced in [0, 1], as in rough_fresnel.cpp.
constexpr std::size_t kAlphas = 17, kCosines = 33;
constexpr int kNormals = 16;

double single(double cosine, float alpha) {
  const Ggx ggx{alpha, alpha};
  const Vec3 wo{static_cast<float>(std::sqrt((1.0 - cosine) * (1.0 + cosine))), 0.0f,
                static_cast<float>(cosine)};
  double sum = 0.0;
  for (int i = 0; i < kNormals; ++i) {
    for (int j = 0; j < kNormals; ++j) {
      // The half circle: wo lies in the plane y = 0.
      const Vec3 h = ggx.sample_visible(wo, (static_cast<float>(i) + 0.5f) / kNormals,
                                        0.5f * (static_cast<float>(j) + 0.5f) / kNormals);
      const Vec3 wi = reflected(wo, h);
      if (wi.z > 0.0f) sum += static_cast<double>(ggx.reflection_weight(wo, wi));
    }
  }
  return sum / (kNormals * kNormals);
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
    // 2 x the integral of e(x) mu dmu, mu = x^2: 4 e(x) x^3 dx, e linear in each cell.
    double mean = 0.0;
    for (std::size_t c = 0; c + 1 < kCosines; ++c) {
      const double x0 = static_cast<double>(c) / (kCosines - 1);
      const double x1 = static_cast<double>(c + 1) / (kCosines - 1);
      const double slope =
          (static_cast<double>(row[c + 1]) - static_cast<double>(row[c])) / (x1 - x0);
      const double base = static_cast<double>(row[c]) - slope * x0;
      mean += base * (std::pow(x1, 4) - std::pow(x0, 4)) +
              slope * 0.8 * (std::pow(x1, 5) - std::pow(x0, 5));
    }
    mean_[a] = static_cast<float>(mean);
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

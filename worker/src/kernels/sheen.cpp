#include "kernels/sheen.h"

#include <cstddef>

#include "kernels/ggx.h"
#include "kernels/table_cell.h"
#include "math/functions.h"

namespace nocturne {
namespace {

// Square roots of alpha and of the cosine, equally spaced in [0, 1]; twice as close as in
// ggx_energy.cpp, for thin fuzz shines in a narrow band.
constexpr std::size_t kAlphas = 33, kCosines = 49;
// Of directions, over the square root of the cosine and over half a circle.
constexpr int kMidpoints = 40;

double albedo(float cosine, float alpha) {
  const Vec3 wo{std::sqrt((1.0f - cosine) * (1.0f + cosine)), 0.0f, cosine};
  double sum = 0.0;
  for (int i = 0; i < kMidpoints; ++i) {
    const float x = (static_cast<float>(i) + 0.5f) / kMidpoints, z = x * x;
    const float side = std::sqrt((1.0f - z) * (1.0f + z));
    for (int j = 0; j < kMidpoints; ++j) {
      const float phi = kPi * (static_cast<float>(j) + 0.5f) / kMidpoints;
      const Vec3 wi{side * math::cos(phi), side * math::sin(phi), z};
      // dz = 2 x dx, both halves of the circle
      const float weight = 2.0f * x * kTwoPi / (kMidpoints * kMidpoints);
      sum += static_cast<double>(weight * SheenEnergy::value(wo, wi, half_vector(wo, wi), alpha));
    }
  }
  return sum;
}

}  // namespace

const SheenEnergy& SheenEnergy::instance() {
  static const SheenEnergy table;
  return table;
}

SheenEnergy::SheenEnergy() : reflected_(kAlphas * kCosines) {
  for (std::size_t a = 0; a < kAlphas; ++a) {
    const float root_alpha = static_cast<float>(a) / static_cast<float>(kAlphas - 1);
    for (std::size_t c = 0; c < kCosines; ++c) {
      const float root = static_cast<float>(c) / static_cast<float>(kCosines - 1);
      reflected_[a * kCosines + c] = static_cast<float>(
          albedo(std::max(1e-4f, root * root), std::max(kMinAlpha, root_alpha * root_alpha)));
    }
  }
}

float SheenEnergy::reflected(float cosine, float alpha) const {
  const TablePlace a = table_place(std::sqrt(alpha) * static_cast<float>(kAlphas - 1), kAlphas);
  const TablePlace c =
      table_place(std::sqrt(std::max(0.0f, cosine)) * static_cast<float>(kCosines - 1), kCosines);
  const auto along = [&](std::size_t index) {
    const float* row = &reflected_[index * kCosines];
    return mix(row[c.index], row[c.index + 1], c.t);
  };
  return mix(along(a.index), along(a.index + 1), a.t);
}

float SheenEnergy::value(Vec3 wo, Vec3 wi, Vec3 h, float alpha) {
  const float sine_2 = std::clamp((1.0f - h.z) * (1.0f + h.z), 0.0f, 1.0f);
  const float density = (2.0f + 1.0f / alpha) * math::pow(sine_2, 0.5f / alpha) / kTwoPi;
  return density * wi.z / (4.0f * std::max(1e-6f, wo.z + wi.z - wo.z * wi.z));
}

}  // namespace nocturne

#include "kernels/brushed_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "kernels/ggx.h"
#include "kernels/ggx_energy.h"
#include "kernels/table_cell.h"
#include "kernels/table_quadrature.h"
#include "math/functions.h"

namespace nocturne {
namespace {

// Square roots of both alphas and of the cosine, and the squared cosine of the azimuth, equally
// spaced in [0, 1].
constexpr std::size_t kAlphas = 9, kAzimuths = 5, kCosines = 17;
constexpr int kNormals = 16;
// Of azimuths for the mean over them.
constexpr int kDirections = 64;

std::size_t place(std::size_t u, std::size_t v) { return u * kAlphas + v; }
float node(std::size_t index, std::size_t count) {
  return static_cast<float>(index) / static_cast<float>(count - 1);
}
TablePlace along(float root, std::size_t count) {
  return table_place(root * static_cast<float>(count - 1), count);
}

struct Albedo {
  double white, grazing;
};

Albedo single(const Ggx& ggx, Vec3 wo) {
  const auto midpoint = [](int i) { return (static_cast<float>(i) + 0.5f) / kNormals; };
  Albedo sum{0.0, 0.0};
  for (int i = 0; i < kNormals; ++i) {
    for (int j = 0; j < kNormals; ++j) {
      const Vec3 h = ggx.sample_visible(wo, midpoint(i), midpoint(j)), wi = reflected(wo, h);
      if (wi.z <= 0.0f) continue;
      const auto weight = static_cast<double>(ggx.reflection_weight(wo, wi));
      sum.white += weight;
      sum.grazing += weight * static_cast<double>(schlick_weight(dot(wo, h)));
    }
  }
  constexpr int kAll = kNormals * kNormals;
  return {std::min(1.0, sum.white / kAll), sum.grazing / kAll};
}

/// f(place) of the four nodes around two alphas.
template <class F>
float between_alphas(const Facets& facets, const F& at) {
  const TablePlace u = along(std::sqrt(facets.alpha_u), kAlphas),
                   v = along(std::sqrt(facets.alpha_v), kAlphas);
  const auto row = [&](std::size_t i) {
    return mix(at(place(i, v.index)), at(place(i, v.index + 1)), v.t);
  };
  return mix(row(u.index), row(u.index + 1), u.t);
}

}  // namespace

const BrushedEnergy& BrushedEnergy::instance() {
  static const BrushedEnergy table;
  return table;
}

BrushedEnergy::BrushedEnergy()
    : reflected_(kAlphas * kAlphas * kAzimuths * kCosines),
      grazing_(reflected_.size()),
      mean_(kAlphas * kAlphas) {
  for (std::size_t u = 0; u < kAlphas; ++u) {
    for (std::size_t v = 0; v < kAlphas; ++v) {
      const auto alpha = [](std::size_t i) {
        return std::max(BoundRoughness::kMin, node(i, kAlphas) * node(i, kAlphas));
      };
      const Ggx ggx{alpha(u), alpha(v)};
      const std::size_t first = place(u, v) * kAzimuths * kCosines;
      std::array<float, kAzimuths> means{};
      for (std::size_t a = 0; a < kAzimuths; ++a) {
        const float x2 = node(a, kAzimuths);
        const std::size_t row = first + a * kCosines;
        for (std::size_t c = 0; c < kCosines; ++c) {
          const float z = std::max(1e-6f, node(c, kCosines) * node(c, kCosines));
          const float side = std::sqrt((1.0f - z) * (1.0f + z));
          const Vec3 wo{side * std::sqrt(x2), side * std::sqrt(1.0f - x2), z};
          const Albedo found = single(ggx, wo);
          reflected_[row + c] = static_cast<float>(found.white);
          grazing_[row + c] = static_cast<float>(found.grazing);
        }
        means[a] = static_cast<float>(cosine_weighted_mean({&reflected_[row], kCosines}));
      }
      for (int d = 0; d < kDirections; ++d) {
        const float x = math::cos(0.5f * kPi * (static_cast<float>(d) + 0.5f) /
                                  static_cast<float>(kDirections));
        const TablePlace a = along(x * x, kAzimuths);
        mean_[place(u, v)] += mix(means[a.index], means[a.index + 1], a.t) / kDirections;
      }
    }
  }
}

float BrushedEnergy::at(const std::vector<float>& table, const Facets& facets, Vec3 w) const {
  const float across = std::max(1e-12f, w.x * w.x + w.y * w.y);
  const TablePlace azimuth = along(w.x * w.x / across, kAzimuths),
                   cosine = along(std::sqrt(std::max(0.0f, w.z)), kCosines);
  return between_alphas(facets, [&](std::size_t alphas) {
    const auto row = [&](std::size_t a) {
      const float* values = &table[(alphas * kAzimuths + a) * kCosines];
      return mix(values[cosine.index], values[cosine.index + 1], cosine.t);
    };
    return mix(row(azimuth.index), row(azimuth.index + 1), azimuth.t);
  });
}

float BrushedEnergy::reflected(const BoundRoughness& roughness, Vec3 w) {
  const Facets& facets = roughness.facets;
  if (!roughness.brushed()) return GgxEnergy::instance().reflected(w.z, facets.alpha_u);
  return instance().at(instance().reflected_, facets, w);
}

float BrushedEnergy::grazing(const BoundRoughness& roughness, Vec3 w) {
  return instance().at(instance().grazing_, roughness.facets, w);
}

float BrushedEnergy::mean(const BoundRoughness& roughness) {
  const Facets& facets = roughness.facets;
  if (!roughness.brushed()) return GgxEnergy::instance().mean(facets.alpha_u);
  return between_alphas(facets, [&](std::size_t alphas) { return instance().mean_[alphas]; });
}

}  // namespace nocturne

// A sum of other kernels with weights that add up to 1. Sampling chooses a part in proportion
// to its weight, the same for all wavelengths; value and density are those of the sum. An opacity
// mask is a blend of a surface and a NullKernel.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/coated_diffuse.h"
#include "kernels/conductor.h"
#include "kernels/dielectric.h"
#include "kernels/diffuse_transmitter.h"
#include "kernels/glazing.h"
#include "kernels/lambertian.h"
#include "kernels/measured.h"
#include "kernels/null_kernel.h"
#include "kernels/phong.h"
#include "kernels/principled.h"
#include "kernels/thin_pane.h"
#include "math/constants.h"
#include "parameters/scalar.h"

namespace nocturne {

/// A kernel that is not a blend, bound. NullKernel first: an unused one costs nothing.
template <int N>
using AnyBoundPart =
    std::variant<BoundNullKernel<N>, BoundLambertian<N>, BoundDiffuseTransmitter<N>,
                 BoundConductor<N>, BoundDielectric<N>, BoundThinPane<N>, BoundCoatedDiffuse<N>,
                 BoundMeasured<N>, BoundPhong<N>, BoundPrincipled<N>, BoundGlazing<N>>;

template <int N>
class BoundBlend {
 public:
  static constexpr std::size_t kMaxParts = 8;

  /// At most kMaxParts times. A part of weight 0 is left out.
  void add(float weight, AnyBoundPart<N> part) {
    if (!(weight > 0.0f)) return;
    parts_[count_].weight = weight;
    parts_[count_].kernel = std::move(part);
    total_ += weight;
    ++count_;
  }

  Spectral<N> albedo(Vec3 wo) const {
    return sum([&](const auto& kernel) { return Spectral<N>(kernel.albedo(wo)); });
  }
  Spectral<N> value(Vec3 wo, Vec3 wi) const {
    return sum([&](const auto& kernel) { return Spectral<N>(kernel.value(wo, wi)); });
  }
  Spectral<N> pdf(Vec3 wo, Vec3 wi) const {
    return sum([&](const auto& kernel) { return Spectral<N>(kernel.pdf(wo, wi)); }) / total_;
  }
  Evaluation<N> evaluate(Vec3 wo, Vec3 wi) const {
    auto r = Evaluation<N>::nothing();
    for (std::size_t i = 0; i < count_; ++i) {
      const Evaluation<N> part =
          std::visit([&](const auto& kernel) { return nocturne::evaluate<N>(kernel, wo, wi); },
                     parts_[i].kernel);
      r.value += parts_[i].weight * part.value;
      r.pdf += parts_[i].weight * part.pdf;
    }
    r.pdf = r.pdf / total_;
    return r;
  }
  std::optional<Draw<N>> sample(Vec3 wo, KernelNumbers numbers, std::size_t lead) const {
    if (count_ == 0) return std::nullopt;
    float left = numbers.part * total_;
    std::size_t chosen = 0;
    while (chosen + 1 < count_ && left >= parts_[chosen].weight) left -= parts_[chosen++].weight;
    // The rest of the number is uniform again.
    numbers.part = std::clamp(left / parts_[chosen].weight, 0.0f, kOneMinusEpsilon);
    auto draw = std::visit(
        [&](const auto& kernel) {
          return std::optional<Draw<N>>(kernel.sample(wo, numbers, lead));
        },
        parts_[chosen].kernel);
    if (draw && draw->delta) draw->factor *= Spectral<N>(total_);
    if (draw) draw->part = static_cast<std::uint32_t>(chosen);
    return draw;
  }
  bool smooth() const {
    return any([](const auto& kernel) { return kernel.smooth(); });
  }
  bool transmits() const {
    return any([](const auto& kernel) { return kernel.transmits(); });
  }

  /// Of all smooth parts together.
  Mueller<N> mueller(Vec3 wo, Vec3 wi, std::uint32_t photons) const {
    MuellerSum<N> parts;
    for (std::size_t i = 0; i < count_; ++i) {
      std::visit(
          [&](const auto& kernel) {
            if (!kernel.smooth()) return;
            parts.add(parts_[i].weight * Spectral<N>(kernel.value(wo, wi)),
                      mueller_of<N>(kernel, wo, Draw<N>{.wi = wi}, photons));
          },
          parts_[i].kernel);
    }
    return parts.mean();
  }
  /// Of the part that drew.
  Mueller<N> mueller_of_delta(Vec3 wo, const Draw<N>& draw, std::uint32_t photons) const {
    return std::visit([&](const auto& kernel) { return mueller_of<N>(kernel, wo, draw, photons); },
                      parts_[draw.part].kernel);
  }

 private:
  struct Part {
    float weight = 0.0f;
    AnyBoundPart<N> kernel;
  };

  template <class F>
  Spectral<N> sum(const F& of) const {
    Spectral<N> r = 0.0f;
    for (std::size_t i = 0; i < count_; ++i)
      r += parts_[i].weight * std::visit(of, parts_[i].kernel);
    return r;
  }
  template <class F>
  bool any(const F& of) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (std::visit(of, parts_[i].kernel)) return true;
    }
    return false;
  }

  std::array<Part, kMaxParts> parts_;
  std::size_t count_ = 0;
  float total_ = 0.0f;
};
static_assert(BoundKernel<BoundBlend<1>, 1> && BoundKernel<BoundBlend<4>, 4>);

struct Blend {
  /// A weight in [0, 1], or the remainder of it.
  struct Factor {
    Scalar weight;
    bool complement = false;
  };
  /// Index of a kernel that is not a blend; weight is the product of the factors.
  struct Part {
    std::uint32_t kernel;
    std::vector<Factor> factors;

    float weight(const SurfacePoint& point) const {
      float product = 1.0f;
      for (const Factor& factor : factors) {
        const float w = std::clamp(factor.weight(point), 0.0f, 1.0f);
        product *= factor.complement ? 1.0f - w : w;
      }
      return product;
    }
  };
  /// At most 8.
  std::vector<Part> parts;

  /// `kernels` is a range of variants.
  template <int N, class Kernels>
  BoundBlend<N> bind(const Kernels& kernels, const Shading<N>& shading) const {
    BoundBlend<N> bound;
    for (const Part& part : parts) {
      const float weight = part.weight(shading.point);
      if (!(weight > 0.0f)) continue;
      std::visit(
          [&](const auto& kernel) {
            if constexpr (requires { bound.add(weight, kernel.bind(shading)); })
              bound.add(weight, kernel.bind(shading));
          },
          kernels[part.kernel]);
    }
    return bound;
  }
};

}  // namespace nocturne

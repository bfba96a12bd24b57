// The closed set of kernels that a scene may hold: one alternative per model, resolved by one jump
// at a vertex.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/blend.h"
#include "kernels/fluorescent_phase.h"
#include "kernels/polarising_filter.h"

namespace nocturne {

using AnyKernel = std::variant<Lambertian, DiffuseTransmitter, Conductor, Dielectric, ThinPane,
                               CoatedDiffuse, Measured, Phong, Principled, Glazing, NullKernel,
                               Blend, Phase, Fluorescent, PolarisingFilter, FluorescentPhase>;

/// Whether f(kernel) holds for the kernel at `index`, or for any part of it where it is a blend.
template <class F>
bool any_part(const std::vector<AnyKernel>& kernels, std::size_t index, const F& f) {
  return std::visit(
      [&]<class K>(const K& kernel) {
        if constexpr (std::is_same_v<K, Blend>) {
          return std::ranges::any_of(kernel.parts, [&](const Blend::Part& part) {
            return any_part(kernels, part.kernel, f);
          });
        } else {
          static_assert(DescribedKernel<K>);
          return f(kernel);
        }
      },
      kernels[index]);
}

/// Throws std::invalid_argument unless every blend has 1 to 8 parts that are there and that are
/// surfaces' kernels, no blends.
inline void check_blends(const std::vector<AnyKernel>& kernels) {
  for (const AnyKernel& kernel : kernels) {
    const Blend* blend = std::get_if<Blend>(&kernel);
    if (blend == nullptr) continue;
    if (blend->parts.empty() || blend->parts.size() > BoundBlend<1>::kMaxParts) {
      throw std::invalid_argument("a blend has 1 to 8 parts");
    }
    for (const Blend::Part& part : blend->parts) {
      if (part.kernel >= kernels.size())
        throw std::invalid_argument("a blend of a kernel that is not there");
      if (std::holds_alternative<Blend>(kernels[part.kernel])) {
        throw std::invalid_argument("a blend of a blend");
      }
      if (std::holds_alternative<Phase>(kernels[part.kernel]) ||
          std::holds_alternative<FluorescentPhase>(kernels[part.kernel])) {
        throw std::invalid_argument("a blend of a phase function");
      }
      if (std::holds_alternative<Fluorescent>(kernels[part.kernel])) {
        throw std::invalid_argument("a blend of a fluorescent kernel");
      }
      if (std::holds_alternative<PolarisingFilter>(kernels[part.kernel])) {
        throw std::invalid_argument("a blend of a polarising filter");
      }
    }
  }
}

/// Blends as check_blends wants them.
template <class Kernel, int N>
auto bind_kernel(const Kernel& kernel, const std::vector<AnyKernel>& kernels,
                 const Shading<N>& shading) {
  if constexpr (requires { kernel.bind(shading); }) {
    return kernel.bind(shading);
  } else {
    return kernel.bind(kernels, shading);
  }
}

/// What binding a kernel makes of it.
template <class Kernel, int N>
using BoundOf = decltype(bind_kernel(std::declval<const Kernel&>(),
                                     std::declval<const std::vector<AnyKernel>&>(),
                                     std::declval<const Shading<N>&>()));

/// f(bound kernel) for the kernel at `index`.
template <int N, class F>
decltype(auto) visit_bound(const std::vector<AnyKernel>& kernels, std::size_t index,
                           const Shading<N>& shading, F&& f) {
  return std::visit(
      [&](const auto& kernel) -> decltype(auto) {
        return std::forward<F>(f)(bind_kernel(kernel, kernels, shading));
      },
      kernels[index]);
}

/// f.operator()<Kernel>(index of the alternative) for each type that a scene may hold.
template <class F>
void for_each_kernel_type(const F& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (f.template operator()<std::variant_alternative_t<I, AnyKernel>>(I), ...);
  }
  (std::make_index_sequence<std::variant_size_v<AnyKernel>>{});
}

}  // namespace nocturne

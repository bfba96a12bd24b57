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
#include "kernels/phase.h"

namespace nocturne {

using AnyKernel = std::variant<Lambertian, DiffuseTransmitter, Conductor, Dielectric, ThinPane,
                               CoatedDiffuse, Measured, Phong, NullKernel, Blend, Phase>;

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
      if (std::holds_alternative<Phase>(kernels[part.kernel])) {
        throw std::invalid_argument("a blend of a phase function");
      }
    }
  }
}

/// f(bound kernel) for the kernel at `index`; blends as check_blends wants them.
template <int N, class F>
decltype(auto) visit_bound(const std::vector<AnyKernel>& kernels, std::size_t index,
                           const Shading<N>& shading, F&& f) {
  // The commonest kernel without a jump through a table: it is inlined, and plain scenes cost what
  // they would cost without all others.
  if (const auto* lambertian = std::get_if<Lambertian>(&kernels[index])) [[likely]] {
    return f(lambertian->bind(shading));
  }
  return std::visit(
      [&](const auto& kernel) -> decltype(auto) {
        if constexpr (requires { kernel.bind(shading); }) {
          return std::forward<F>(f)(kernel.bind(shading));
        } else {
          return std::forward<F>(f)(kernel.bind(kernels, shading));
        }
      },
      kernels[index]);
}

}  // namespace nocturne

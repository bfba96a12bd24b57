// The groups of a wave in the order of the types of kernels that they meet, so that those of one
// type are scattered together. Groups of one type keep their order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/any_kernel.h"

namespace nocturne {

class KernelOrder {
 public:
  static constexpr std::size_t kTypes = std::variant_size_v<AnyKernel>;

  /// `kernel_of(i)` is the kernel that group i meets, or null where it ends.
  template <class KernelAt>
  void sort(std::size_t groups, const KernelAt& kernel_of) {
    types_.resize(groups);
    order_.resize(groups);
    first_.fill(0);
    for (std::size_t i = 0; i < groups; ++i) {
      const AnyKernel* kernel = kernel_of(i);
      types_[i] = kernel != nullptr ? static_cast<std::uint8_t>(kernel->index()) : kTypes;
      ++first_[types_[i] + 1u];
    }
    for (std::size_t type = 0; type <= kTypes; ++type) first_[type + 1] += first_[type];
    auto next = first_;
    for (std::size_t i = 0; i < groups; ++i) {
      order_[next[types_[i]]++] = static_cast<std::uint32_t>(i);
    }
  }

  /// Groups that meet a kernel of the type, by their index.
  std::span<const std::uint32_t> of(std::size_t type) const {
    return std::span(order_).subspan(first_[type], first_[type + 1] - first_[type]);
  }

 private:
  std::vector<std::uint8_t> types_;
  std::vector<std::uint32_t> order_;
  /// Of a type, in `order_`; behind all types, those that end.
  std::array<std::uint32_t, kTypes + 2> first_;
};

}  // namespace nocturne

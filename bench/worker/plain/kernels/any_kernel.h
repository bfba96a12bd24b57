// In the place of worker/src/kernels/any_kernel.h: a tracer that knows diffuse surfaces only.
#pragma once

#define visit_bound visit_any_bound
#define for_each_kernel_type for_each_any_kernel_type
#include "../../../../worker/src/kernels/any_kernel.h"
#undef visit_bound
#undef for_each_kernel_type

namespace nocturne {

template <int N, class F>
decltype(auto) visit_bound(const std::vector<AnyKernel>& kernels, std::size_t index,
                           const Shading<N>& shading, F&& f) {
  return f(std::get<Lambertian>(kernels[index]).bind(shading));
}

template <class F>
void for_each_kernel_type(const F& f) {
  static_assert(std::is_same_v<std::variant_alternative_t<0, AnyKernel>, Lambertian>);
  f.template operator()<Lambertian>(0);
}

}  // namespace nocturne

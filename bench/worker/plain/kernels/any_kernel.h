// In the place of worker/src/kernels/any_kernel.h: a tracer that knows diffuse surfaces only.
#pragma once

#define visit_bound visit_any_bound
#include "../../../../worker/src/kernels/any_kernel.h"
#undef visit_bound

namespace nocturne {

template <int N, class F>
decltype(auto) visit_bound(const std::vector<AnyKernel>& kernels, std::size_t index,
                           const Shading<N>& shading, F&& f) {
  return f(std::get<Lambertian>(kernels[index]).bind(shading));
}

}  // namespace nocturne

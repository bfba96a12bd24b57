// What interactions do to the polarisation that a group's photons know.
#pragma once

#include "tracer/batch.h"

namespace nocturne {

template <int N>
struct PassedOn {
  Polarisation<N> beyond;
  /// Of the weight, besides what the kernel does to unpolarised light.
  Spectral<N> factor;
};

/// Past a vertex, where light comes from `wi`, in its frame.
template <class Batch, int N, class Kernel>
PassedOn<N> pass_vertex(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                        const Kernel& kernel, Vec3 wi) {
  const Vec3 comes = -vertex.to_world(wi), leaves = -group.ray.direction;
  PassedOn<N> passed{batch.estimator.polarisations()[group.sample], 1.0f};
  if constexpr (requires { kernel.axis; }) {
    passed.beyond.turn_to(across_ray(kernel.axis, leaves), leaves);
  } else {
    passed.beyond.turn_to(across_both(comes, leaves), leaves);
  }
  passed.factor = passed.beyond.pass(mueller_of<N>(kernel, vertex.wo, wi));
  return passed;
}

template <class Batch, int N, class Kernel>
void polarise(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
              Vec3 wi) {
  const PassedOn<N> passed = pass_vertex(batch, group, vertex, kernel, wi);
  group.weight *= passed.factor;
  batch.change_polarisation(group, passed.beyond);
}

}  // namespace nocturne

// Photons from the sensor at fluorescent surfaces. Light that left at their wavelength was
// reflected there, or came at another one and excited the surface: one of both is chosen, with its
// weight, and from then on the photon has the other wavelength, for lights, media and all surfaces
// to come.
#pragma once

#include <algorithm>

#include "tracer/batch.h"

namespace nocturne {

/// Each is tried so often at least where both are possible: photons of a group have one choice,
/// though they may differ.
inline constexpr float kLeastTried = 0.1f;

/// The part of a group's photons that were emitted.
template <int N>
float chance_of_emission(const Spectral<N>& reflected, const Spectral<N>& emitted) {
  const float by_emission = sum(emitted), all = sum(reflected) + by_emission;
  if (!(by_emission > 0.0f)) return 0.0f;
  if (!(all > by_emission)) return 1.0f;
  return std::clamp(by_emission / all, kLeastTried, 1.0f - kLeastTried);
}

/// Then a direction is drawn, which is the same for both: light is spread by the cosine.
template <class Batch, int N>
BoundLambertian<N> reflect_or_emit(Batch& batch, Group<N>& group, Vertex<N>& vertex,
                                   const Fluorescent& kernel) {
  const BoundLambertian<N> reflects = kernel.bind(vertex.shading);
  const Spectral<N> wavelengths = vertex.shading.wavelengths;
  const float emission = chance_of_emission<N>(group.weight * reflects.reflectance,
                                               group.weight * kernel.emitted(wavelengths));
  const Uniform4 u = group.sequence.next();
  if (u[0] >= emission) {
    group.weight *= Spectral<N>(1.0f / (1.0f - emission));
    return reflects;
  }
  const auto excitation = kernel.excite(wavelengths, u[1], u[2]);
  group.weight *= (1.0f / emission) * excitation.weight;
  batch.change_wavelengths(group, excitation.wavelengths);
  vertex.shading.wavelengths = excitation.wavelengths;
  return BoundLambertian<N>(1.0f);
}

/// The kernel at a vertex.
template <class Batch, int N, class Kernel>
auto bind_at(Batch& batch, Group<N>&, Vertex<N>& vertex, const Kernel& kernel) {
  return bind_kernel(kernel, batch.scene.kernels, vertex.shading);
}
template <class Batch, int N>
BoundLambertian<N> bind_at(Batch& batch, Group<N>& group, Vertex<N>& vertex,
                           const Fluorescent& kernel) {
  return reflect_or_emit(batch, group, vertex, kernel);
}

}  // namespace nocturne

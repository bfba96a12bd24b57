// Photons from the sensor at fluorescent surfaces. Light that left at their wavelength was
// reflected there, or came at another one and excited the surface: one of both is chosen, with its
// weight, and from then on the photon has the other wavelength, for lights, media and all surfaces
// to come. In media photons branch, as a dye may be clear where it emits.
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
  const Fluorophores& dyes = kernel.fluorophores;
  const Spectral<N> wavelengths = vertex.shading.wavelengths;
  const float emission = chance_of_emission<N>(group.weight * reflects.reflectance,
                                               group.weight * dyes.emitted(wavelengths));
  const Uniform4 u = group.sequence.next();
  if (u[0] >= emission) {
    group.weight *= Spectral<N>(1.0f / (1.0f - emission));
    return reflects;
  }
  const auto excitation = dyes.excite(wavelengths, u[1], u[2]);
  group.weight *= (1.0f / emission) * excitation.weight;
  batch.change_wavelengths(group, excitation.wavelengths);
  vertex.shading.wavelengths = excitation.wavelengths;
  return BoundLambertian<N>(1.0f);
}

/// Of photons of a group that go on with their wavelength, the part that a particle scatters; for
/// the others nothing was there.
template <int N>
float chance_of_scattering(const Spectral<N>& scattered, const Spectral<N>& passed) {
  return 1.0f - chance_of_emission<N>(scattered, passed);
}

/// The n-th collision of a path becomes an emission with the probability kTries / n, at most, and
/// with so much more weight: a photon that passes a dense dye has few branches, and the sum of
/// their weights is spread by no more than its mean, however dense the dye is.
inline constexpr float kTries = 2.0f;

/// Dyes may have emitted light where a group collided: photons of other wavelengths branch off.
template <class Batch, int N>
void branch_off_emission(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                         const FluorescentPhase& kernel, const Spectral<N>& emitted) {
  PhotonSequence sequence = group.sequence.branch(3);
  const Uniform4 u = sequence.next();
  const float tried = std::min(1.0f, kTries / static_cast<float>(group.collisions));
  if (u[0] >= tried || !(largest(group.weight * emitted) > 0.0f)) return;
  Group<N> on = group;
  on.sequence = sequence;
  on.shares = false;
  const auto excitation =
      kernel.fluorophores.excite(batch.sample_of(group).wavelengths, u[1], u[2]);
  on.weight *= (1.0f / tried) * excitation.weight;
  if (!(largest(on.weight) > 0.0f)) return;
  batch.change_wavelengths(on, excitation.wavelengths);
  batch.emitted.push_back({on, vertex.hit});
}

/// Photons that go on with their wavelength; those that dyes may have emitted branch off.
template <class Batch, int N>
BoundFluorescentPhase<N> scatter_or_pass(Batch& batch, Group<N>& group, Vertex<N>& vertex,
                                         const FluorescentPhase& kernel) {
  const auto parts = kernel.parts(vertex.shading.wavelengths);
  const Uniform4 u = group.sequence.next();
  if constexpr (Batch::kAdjoint) {
    Group<N> at = group;
    at.weight *= each([](float all) { return all > 0.0f ? 1.0f / all : 0.0f; }, parts.collisions);
    branch_off_emission(batch, at, vertex, kernel, parts.emitted);
  }
  const float scatters =
      chance_of_scattering<N>(group.weight * parts.scattered, group.weight * parts.passed);
  if (u[0] < scatters) {
    group.weight *= Spectral<N>(1.0f / scatters);
    return {kernel.phase.bind(vertex.shading, parts.scattered)};
  }
  group.weight *= (1.0f / (1.0f - scatters)) * parts.passed;
  return {BoundPhase<N>(1.0f, HenyeyGreenstein(0.0)), true};
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
template <class Batch, int N>
BoundFluorescentPhase<N> bind_at(Batch& batch, Group<N>& group, Vertex<N>& vertex,
                                 const FluorescentPhase& kernel) {
  return scatter_or_pass(batch, group, vertex, kernel);
}

}  // namespace nocturne

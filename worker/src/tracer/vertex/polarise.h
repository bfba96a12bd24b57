// What interactions do to the polarisation that a group's photons know.
#pragma once

#include "tracer/batch.h"

namespace nocturne {

/// Light leaves a vertex towards the sensor, and comes from where it was drawn to come from.
struct PassedRays {
  Vec3 comes, leaves;
  /// What the kernel's matrix refers to.
  Vec3 reference;
};

template <int N, class Kernel>
PassedRays rays_past(const Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
                     Vec3 wi) {
  PassedRays rays{-vertex.to_world(wi), -group.ray.direction, {}};
  if constexpr (requires { kernel.axis; }) {
    rays.reference = across_ray(kernel.axis, rays.leaves);
  } else {
    // Light that goes straight on was in a pane all the same.
    const bool straight = along_each_other(rays.comes, rays.leaves);
    rays.reference = across_both(straight ? vertex.frame.normal : rays.comes, rays.leaves);
  }
  return rays;
}

/// Past a vertex.
template <class Batch, int N, class Kernel>
requires(Batch::kPolarised) void polarise(Batch& batch, Group<N>& group, const Vertex<N>& vertex,
                                          const Kernel& kernel, const Draw<N>& draw) {
  if constexpr (!Polarises<Kernel, N> && !PolarisesByPart<Kernel, N>) {
    if (batch.estimator.polarisations()[group.sample].depolarised) return;
    Polarisation<N> beyond = batch.estimator.polarisations()[group.sample];
    beyond.depolarise();
    batch.change_polarisation(group, beyond);
  } else {
    const PassedRays rays = rays_past(group, vertex, kernel, draw.wi);
    Polarisation<N> beyond = batch.estimator.polarisations()[group.sample];
    beyond.turn_to(rays.reference, rays.leaves);
    group.weight *= beyond.pass(mueller_of<N>(kernel, vertex.wo, draw, alive(group.weight)));
    batch.change_polarisation(group, beyond);
  }
}

/// Of light that comes straight from a luminaire.
template <class Batch, int N, class Kernel>
requires(Batch::kPolarised) MetLight<N> polarise_light(Batch& batch, const Group<N>& group,
                                                       const Vertex<N>& vertex,
                                                       const Kernel& kernel, Vec3 wi,
                                                       Spectral<N>& found) {
  const Polarisation<N>& here = batch.estimator.polarisations()[group.sample];
  if constexpr (!Polarises<Kernel, N> && !PolarisesByPart<Kernel, N>) {
    return {1.0f, here.first_column()};
  } else {
    const PassedRays rays = rays_past(group, vertex, kernel, wi);
    const auto by = mueller_of<N>(kernel, vertex.wo, Draw<N>{.wi = wi}, alive(group.weight));
    const MetLight<N> met = here.meet(rays.reference, rays.leaves, by);
    found *= met.factor;
    return met;
  }
}

/// Part of the light of the latest shadow ray. For Stokes vectors its light group does not matter.
template <class Batch, int N>
void add_shadow_light(Batch& batch, const MetLight<N>& met, std::uint32_t light_group,
                      const Spectral<N>& part) {
  if (!batch.scene.wavelengths.tells_stokes()) {
    batch.shadow_lights.push_back({batch.shadow_rays.size() - 1, light_group, part});
    return;
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    batch.shadow_lights.push_back({batch.shadow_rays.size() - 1, i, part * met.stokes[i]});
  }
}

template <class Batch, int N>
requires(Batch::kPolarised) void start_polarisation(Batch& batch, const Start<N>& from,
                                                    std::uint32_t flight) {
  const Vec3 up = batch.scene.sensor.motion().at(from.time).up;
  batch.estimator.polarisations().push_back(
      Polarisation<N>::at_sensor(across_both(from.ray.direction, up), flight));
}

// Where nobody asks: calls, so that the loop has the same branches, and its profile fits.
struct Unpolarised {};
template <class Batch, int N, class Kernel>
void polarise(Batch&, Group<N>&, const Vertex<N>&, const Kernel&, const Draw<N>&) {}
template <class Batch, int N, class Kernel>
Unpolarised polarise_light(Batch&, const Group<N>&, const Vertex<N>&, const Kernel&, Vec3,
                           Spectral<N>&) {
  return {};
}
template <class Batch, int N>
void add_shadow_light(Batch& batch, Unpolarised, std::uint32_t light_group,
                      const Spectral<N>& part) {
  batch.shadow_lights.push_back({batch.shadow_rays.size() - 1, light_group, part});
}
template <class Batch, int N>
void start_polarisation(Batch&, const Start<N>&, std::uint32_t) {}

}  // namespace nocturne

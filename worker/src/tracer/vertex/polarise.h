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

/// Past a vertex, where light comes from where it was drawn to go, in its frame.
template <class Batch, int N, class Kernel>
PassedOn<N> pass_vertex(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                        const Kernel& kernel, const Draw<N>& draw) {
  const Vec3 comes = -vertex.to_world(draw.wi), leaves = -group.ray.direction;
  PassedOn<N> passed{batch.estimator.polarisations()[group.sample], 1.0f};
  if constexpr (requires { kernel.axis; }) {
    passed.beyond.turn_to(across_ray(kernel.axis, leaves), leaves);
  } else {
    // Light that goes straight on was in a pane all the same.
    const bool straight = along_each_other(comes, leaves);
    passed.beyond.turn_to(across_both(straight ? vertex.frame.normal : comes, leaves), leaves);
  }
  passed.factor = passed.beyond.pass(mueller_of<N>(kernel, vertex.wo, draw, alive(group.weight)));
  return passed;
}

template <class Batch, int N, class Kernel>
requires(Batch::kPolarised) void polarise(Batch& batch, Group<N>& group, const Vertex<N>& vertex,
                                          const Kernel& kernel, const Draw<N>& draw) {
  const PassedOn<N> passed = pass_vertex(batch, group, vertex, kernel, draw);
  group.weight *= passed.factor;
  batch.change_polarisation(group, passed.beyond);
}

/// Of light that comes straight from a luminaire.
template <class Batch, int N, class Kernel>
requires(Batch::kPolarised) PassedOn<N> polarise_light(Batch& batch, const Group<N>& group,
                                                       const Vertex<N>& vertex,
                                                       const Kernel& kernel, Vec3 wi,
                                                       Spectral<N>& found) {
  const PassedOn<N> passed = pass_vertex(batch, group, vertex, kernel, Draw<N>{.wi = wi});
  found *= passed.factor;
  return passed;
}

/// Part of the light of the latest shadow ray. For Stokes vectors its light group does not matter.
template <class Batch, int N>
void add_shadow_light(Batch& batch, const PassedOn<N>& passed, std::uint32_t light_group,
                      const Spectral<N>& part) {
  if (!batch.scene.wavelengths.tells_stokes()) {
    batch.shadow_lights.push_back({batch.shadow_rays.size() - 1, light_group, part});
    return;
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    batch.shadow_lights.push_back(
        {batch.shadow_rays.size() - 1, i, part * passed.beyond.to_sensor[i + 1][0]});
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

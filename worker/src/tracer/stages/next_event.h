// Next event estimation: a second photon from a vertex, drawn towards lights and important shapes.
// It counts what it meets with its MIS weight, through mirrors and clear glass too, and ends on the
// first surface without a delta lobe: there the one from the kernel carries the whole weight.
#pragma once

#include "tracer/stages/directions.h"

namespace nocturne {

/// From within glass no light lies where it seems to. A surface that scatters light in there may
/// still stand before one in the same glass; a medium has too many vertices to try at each.
template <class Batch, int N>
bool may_see_lights(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  return !batch.is_medium(vertex.hit) ||
         group.inside.current(batch.scene.medium_interfaces) == InteriorList::kOutside;
}

template <class Batch, int N, class Kernel>
void estimate_next_event(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                         const Kernel& kernel, float survival) {
  if (batch.scene.occlusion_decides) {
    return sample_light(batch, group, vertex, kernel, survival);
  }
  PhotonSequence sequence = group.sequence.branch(1);
  const Uniform4 u = sequence.next();
  const LightSamplingContext here = light_context(batch, group, vertex, kernel);
  const auto direction = batch.scene.lights.sample(here, u[2], u[0], u[1]);
  if (!direction) return;
  const Vec3 wi = vertex.to_local(*direction);
  if (wi.z <= 0.0f && !kernel.transmits()) return;
  Group<N> photon = group;
  photon.sequence = sequence;
  photon.weight *= kernel.value(vertex.wo, wi);
  photon.mis = {MisTechnique::kLights, here, *direction, survival * kernel.pdf(vertex.wo, wi)};
  go_on(batch, photon, vertex, wi, false);
}

/// Where nothing between can let light through: what the nearest light there brings, if the way is
/// free.
template <class Batch, int N, class Kernel>
void sample_light(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                  const Kernel& kernel, float survival) {
  if (group.depth - group.passes > batch.options.max_depth) return;
  const Scene& scene = batch.scene;
  const BatchSample<N>& sample = batch.sample_of(group);
  const Uniform4 u = group.sequence.branch(1).next();
  const LightSamplingContext here = light_context(batch, group, vertex, kernel);
  const auto light =
      scene.lights.sample_light(here, vertex.hit.normal, vertex.hit.clearance, u[2], u[0], u[1]);
  if (!light) return;
  const Vec3 wi = vertex.to_local(light->direction);
  if (wi.z <= 0.0f && !kernel.transmits()) return;
  // Where a shading normal says one side and the surface the other, nothing goes on.
  if (dot(vertex.normal, light->direction) * wi.z <= 0.0f) return;
  const Spectral<N> radiance = light->luminaire == Emission::kNoLuminaire
                                   ? scene.distant_radiance(light->direction, sample.wavelengths)
                                   : scene.luminaires[light->luminaire].emitted(
                                         light->normal, -light->direction, {}, sample.wavelengths);
  Spectral<N> found = group.weight * kernel.value(vertex.wo, wi) * radiance;
  if (!(largest(found) > 0.0f)) return;
  found *= each([&](float pdf) { return 1.0f / (pdf + light->pdf); },
                survival * kernel.pdf(vertex.wo, wi));
  batch.shadow_rays.push_back({{{leave_surface(vertex.hit, light->direction), light->direction},
                                sample.time,
                                light->free_distance},
                               group.sample,
                               found});
}

/// Such a photon where it meets a surface that has a delta lobe.
template <class Batch, int N, class Kernel>
void pass_on(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel) {
  const Uniform4 u = group.sequence.next();
  const float survival =
      std::min(1.0f, largest(only(kernel.albedo(vertex.wo), alive(group.weight))));
  if (u[2] >= survival) return;
  for_each_draw(
      batch, group, vertex, kernel, {u[3], u[0], u[1]}, [&](Group<N>& on, const Draw<N>& draw) {
        on.weight = draw.delta ? (1.0f / survival) * on.weight * draw.factor : Spectral<N>(0.0f);
      });
}

}  // namespace nocturne

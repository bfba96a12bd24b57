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

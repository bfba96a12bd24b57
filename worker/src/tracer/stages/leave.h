// From a vertex to the next ray.
#pragma once

#include "tracer/near_ends.h"
#include "tracer/stages/travel.h"

namespace nocturne {

template <class Batch, int N>
bool near_camera(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  return near_camera(batch.scene, vertex.hit.position, batch.sample_of(group).time);
}

/// Where the ray of a photon starts that leaves a vertex in `direction`: moved off its surface, by
/// which a thin lamp lies elsewhere than it does from the vertex.
template <class Batch, int N>
Vec3 leaves_from(const Batch& batch, const Vertex<N>& vertex, Vec3 direction) {
  const bool exact = batch.is_medium(vertex.hit) ||
                     (batch.scene.materials[vertex.hit.surface].close && !batch.occlusion_decides);
  return exact ? vertex.hit.position : leave_surface(vertex.hit, direction);
}

/// What a photon met at a vertex, as far as path_partition.h asks.
template <class Batch, int N>
Interaction interaction_at(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                           bool delta, bool straight) {
  const bool first = Batch::kAdjoint && group.depth == 1;
  const bool of_luminaire = !Batch::kAdjoint && !group.ends.specular_like_at_luminaire;
  return {
      .specular_like = batch.scene.specular_like[vertex.kernel],
      .delta = delta,
      .straight = straight,
      .near_camera = first && near_camera(batch, group, vertex),
      .near_luminaire = of_luminaire && near_luminaire(batch.scene, group, vertex.hit.position)};
}

/// With photons in both directions: notes the interaction that a group leaves by. False where the
/// other direction has all that could come of it.
template <class Batch, int N>
bool keep_in_partition(const Batch& batch, Group<N>& group, const Vertex<N>& vertex, Vec3 wi,
                       bool delta) {
  const Interaction latest = interaction_at(batch, group, vertex, delta, delta && wi == -vertex.wo);
  if constexpr (Batch::kAdjoint) {
    group.ends = after_adjoint(group.ends, latest, group.depth == 1);
    if (!delta) group.mis.context.position = leaves_from(batch, vertex, vertex.to_world(wi));
    return true;
  } else {
    group.ends = after_forward(group.ends, latest);
    return forward_goes_on(group.ends, latest);
  }
}

/// Whether a kernel may send anything in a direction, `wi` in its frame. Where a shading normal
/// says one side and the surface, by the cosine with its normal, the other, nothing goes on.
template <class Kernel>
bool may_send(const Kernel& kernel, float cosine, Vec3 wi) {
  return (wi.z > 0.0f || kernel.transmits()) && cosine * wi.z > 0.0f;
}

/// Turns a group into `wi`; false where it ends.
template <class Batch, int N>
bool leave(const Batch& batch, Group<N>& group, const Vertex<N>& vertex, Vec3 wi, bool delta) {
  if (!(largest(group.weight) > 0.0f)) return false;
  if (batch.knows_ends && !keep_in_partition(batch, group, vertex, wi, delta)) return false;
  // What passes straight through a pane or a hole has met nothing.
  if (delta && wi == -vertex.wo) {
    ++group.passes;
  } else if (group.depth - group.passes > batch.options.max_depth) {
    return false;
  }
  group.scattered = group.scattered || !delta;
  const Vec3 direction = vertex.to_world(wi);
  const float cosine = dot(vertex.normal, direction);
  // A medium has no sides, and turns one of 2^24 photons to go exactly across.
  if (!batch.is_medium(vertex.hit)) {
    // Where a shading normal says one side and the surface the other, nothing goes on.
    if (cosine * wi.z <= 0.0f) return false;
    if (cosine < 0.0f) group.inside = vertex.beyond;
    if constexpr (!Batch::kAdjoint) {
      // A shading normal is not symmetric: flux is scaled by the cosines that radiance is not.
      // Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, eq. 5.19.
      group.weight *= Spectral<N>(
          std::fabs(cosine * vertex.wo.z / (dot(vertex.normal, group.ray.direction) * wi.z)));
    }
  }
  start_off(batch.scene, group, vertex.hit, direction, batch.sample_of(group).time);
  return true;
}

/// Sends a copy on to the next wave, after `change` was made to it.
template <class Batch, int N, class Change>
void go_on(Batch& batch, const Group<N>& group, const Vertex<N>& vertex, Vec3 wi, bool delta,
           const Change& change) {
  Group<N>& on = batch.next.emplace_back(group);
  change(on);
  if (!leave(batch, on, vertex, wi, delta)) batch.next.pop_back();
}

}  // namespace nocturne

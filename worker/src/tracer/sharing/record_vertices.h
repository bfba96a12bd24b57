// First and second vertices of paths are noted where neighbouring pixels share them. Which photons
// take part depends on the two vertices alone, never on the light that is found.
#pragma once

#include <type_traits>

#include "kernels/diffuse_transmitter.h"
#include "kernels/lambertian.h"
#include "tracer/vertex/travel.h"

namespace nocturne {

/// Between two vertices in empty space nothing is lost, unless a surface stands between.
template <class Batch, int N>
bool may_share_at(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  return group.inside.empty() && vertex.beyond.empty() && !batch.is_medium(vertex.hit) &&
         !batch.scene.materials[vertex.hit.surface].close;
}

/// True where the group has its next numbers from the block.
template <class Batch, int N, class Kernel>
bool record_first_vertex(Batch& batch, Group<N>& group, const Vertex<N>& vertex,
                         const Kernel& kernel, float survival) {
  if (!kernel.smooth() || !may_share_at(batch, group, vertex)) return false;
  group.shares = true;
  const bool diffuse_like =
      batch.both && !batch.scene.specular_like[vertex.kernel] && !near_camera(batch, group, vertex);
  batch.sharing.firsts[group.sample].emplace(
      FirstVertex<N>{vertex.hit, vertex.frame, vertex.normal, vertex.wo, vertex.kernel,
                     vertex.shading, survival, group.weight, diffuse_like});
  return true;
}

/// Of a bound kernel whose value is the same for every wo on one side: what a second vertex sends
/// to its own first vertex, it sends to all that see it from there.
template <class Kernel, int N>
inline constexpr bool kSendsAlike = std::is_same_v<Kernel, BoundLambertian<N>> ||
                                    std::is_same_v<Kernel, BoundDiffuseTransmitter<N>>;

/// From here on the group counts apart, as of weight 1.
template <class Batch, int N, class Kernel>
void record_second_vertex(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel&) {
  if constexpr (kSendsAlike<Kernel, N>) {
    if (!may_share_at(batch, group, vertex) || vertex.own_normal) return;
    const std::uint32_t tally = batch.estimator.add_tally();
    batch.sharing.seconds.push_back({.sample = group.sample,
                                     .tally = tally,
                                     .weight = group.weight,
                                     .hit = vertex.hit,
                                     .normal = vertex.normal,
                                     .frame_normal = vertex.frame.normal});
    group.weight = only(Spectral<N>(1.0f), alive(group.weight));
    group.tally = tally;
  }
}

}  // namespace nocturne

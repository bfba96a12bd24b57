// First and second vertices of paths are noted where neighbouring pixels share them. Who takes part
// depends on the two vertices alone, never on what is found.
#pragma once

#include <type_traits>

#include "kernels/lambertian.h"
#include "tracer/stages/leave.h"

namespace nocturne {

/// Between two vertices in empty space nothing is lost, unless a surface stands between.
template <class Batch, int N>
bool may_share_at(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  return group.inside.empty() && vertex.beyond.empty() && !batch.is_medium(vertex.hit) &&
         !batch.scene.materials[vertex.hit.surface].close;
}

/// True where the group has its next numbers from the block.
template <class Batch, int N, class Kernel>
bool offer_first(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
                 float survival) {
  if (!kernel.smooth() || !may_share_at(batch, group, vertex)) return false;
  group.shares = true;
  const bool diffuse_like =
      batch.both && !batch.scene.specular_like[vertex.kernel] && !near_camera(batch, group, vertex);
  batch.sharing.firsts[group.sample].emplace(
      FirstVertex<N>{vertex.hit, vertex.frame, vertex.normal, vertex.wo, vertex.kernel,
                     vertex.shading, survival, group.weight, diffuse_like});
  return true;
}

/// From here on the group counts apart, as of weight 1.
template <class Batch, int N, class Kernel>
void offer_second(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel) {
  if constexpr (HasDiffusePart<Kernel, N>) {
    if (!may_share_at(batch, group, vertex) || vertex.own_normal) return;
    constexpr bool kLambertian = std::is_same_v<Kernel, BoundLambertian<N>>;
    if constexpr (!kLambertian) {
      // Which direction of photons brings what is mirrored is told by more than this vertex.
      if (batch.both && batch.scene.specular_like[vertex.kernel]) return;
      if (!(largest(kernel.diffuse_value(vertex.wo, {0.0f, 0.0f, 1.0f})) > 0.0f)) return;
      group.second = static_cast<std::uint32_t>(batch.sharing.seconds.size());
    }
    const std::uint32_t tally = batch.estimator.add_tally();
    batch.sharing.seconds.push_back({.sample = group.sample,
                                     .tally = tally,
                                     .weight = group.weight,
                                     .hit = vertex.hit,
                                     .normal = vertex.normal,
                                     .frame = vertex.frame,
                                     .lambertian = kLambertian,
                                     .wo = vertex.wo,
                                     .kernel = vertex.kernel,
                                     .shading = vertex.shading});
    group.weight = only(Spectral<N>(1.0f), alive(group.weight));
    group.tally = tally;
  }
}

/// Where what comes to a group from `wi` is counted.
template <class Batch, int N>
std::uint32_t tally_from(Batch& batch, const Group<N>& group, Vec3 wi) {
  if (!Batch::kAdjoint || group.second == Group<N>::kNone) return group.tally;
  if constexpr (Batch::kAdjoint) {
    SecondVertex<N>& second = batch.sharing.seconds[group.second];
    const std::uint32_t tally = batch.estimator.add_tally();
    batch.sharing.arrivals.push_back({wi, tally, second.arrivals});
    second.arrivals = static_cast<std::uint32_t>(batch.sharing.arrivals.size() - 1);
    return tally;
  }
}

}  // namespace nocturne

// Stage: what groups do at a surface or in a medium. The kernel is bound to the vertex once;
// photons go towards lights, roulette decides, and directions are drawn.
#pragma once

#include "tracer/stages/connect.h"
#include "tracer/stages/next_event.h"
#include "tracer/stages/offer.h"

namespace nocturne {

/// In unbounded fog that absorbs little, photons would wander without end. From a distance r one
/// flight meets a ball of radius R with (R / r)^2, and a long walk with R / r. At the latter its
/// expected length would still be infinite, as a walk to r takes r^2 flights.
template <class Batch, int N>
float chance_to_stay(const Batch& batch, const Group<N>& group, Vec3 position) {
  const auto& [centre, radius] = *batch.scene.all_in_fog;
  const Vec3 away = position - centre;
  return std::min(1.0f, largest(group.weight) * radius * radius / dot(away, away));
}

/// The paper's survival probability is H h. Times the weight that the photon carries, light photons
/// die and heavy ones stay (docs/decisions/0004-roulette-by-weight.md). One probability for the
/// group: it stays together as long as one of them is worth it.
template <class Batch, int N, class Kernel>
float survival_at(const Batch& batch, Group<N>& group, const Vertex<N>& vertex,
                  const Kernel& kernel) {
  const TracingOptions& options = batch.options;
  float survival = 1.0f;
  if (group.depth > options.roulette_after) {
    Spectral<N> albedo = kernel.albedo(vertex.wo);
    count_caught(group, kernel, albedo);
    if (batch.kAdjoint && !group.inside.empty()) albedo *= square_of_index(batch, group);
    survival = std::min(
        1.0f, options.h * largest(options.roulette_by_weight ? albedo * group.weight
                                                             : only(albedo, alive(group.weight))));
  }
  survival = std::min(survival, survival_of_many(group));
  if (batch.scene.all_in_fog) {
    survival = std::min(survival, chance_to_stay(batch, group, vertex.hit.position));
  }
  return survival;
}

/// Before it is known what becomes of a group; and its next numbers.
template <class Batch, int N, class Bound>
void prepare(Batch& batch, Chunk<N, Bound>& chunk) {
  std::array<PhotonSequence*, kChunk> sequences;
  const bool nearly = batch.options.gathered >= TracingOptions::Gathered::kNearlyMet;
  const bool second = batch.kAdjoint && batch.options.estimator == Estimator::kTwoPhotons &&
                      !batch.scene.lights.empty() && !nearly;
  for (std::size_t i = 0; i < chunk.count; ++i) {
    Group<N>& group = *chunk.groups[i];
    Vertex<N>& vertex = *chunk.vertices[i];
    const Bound& kernel = *chunk.kernels[i];
    const bool passes_on = group.mis.technique == MisTechnique::kLights;
    const bool scatters = !passes_on && kernel.smooth();
    if (Batch::kAdjoint && scatters) vertex.learned = learned_at(batch, group, vertex);
    chunk.two_photons[i] = second && scatters && may_see_lights(batch, group, vertex);
    if constexpr (Batch::kAdjoint) {
      if (group.shares) offer_second(batch, group, vertex, kernel);
      group.shares = false;
    }
    chunk.survival[i] = passes_on ? survival_of_passing(batch, group, vertex, kernel)
                                  : survival_at(batch, group, vertex, kernel);
    sequences[i] = &group.sequence;
    if constexpr (Batch::kAdjoint) {
      if (batch.sharing.on() && chunk.two_photons[i] && group.depth == 1 && group.passes == 0 &&
          offer_first(batch, group, vertex, kernel, chunk.survival[i])) {
        group.sequence.skip(1);
        sequences[i] = &batch.sharing.sequences[group.sample];
      }
    }
  }
  PhotonSequence::next_of_each(
      chunk.count, [&](std::size_t i) -> PhotonSequence& { return *sequences[i]; },
      chunk.numbers.data());
}

/// A ball of glass shows a lamp by 4 % of a photon in some hundred: half of all that meet glass
/// first are mirrored where lamps are widened.
template <int N>
KernelNumbers::Halves halves(const TracingOptions& options, const Group<N>& group) {
  using Gathered = TracingOptions::Gathered;
  if (options.gathered < Gathered::kNearlyMet || group.depth - group.passes > 1) {
    return KernelNumbers::Halves::kNo;
  }
  return options.gathered == Gathered::kNearlyMetSquared ? KernelNumbers::Halves::kOfSquare
                                                         : KernelNumbers::Halves::kYes;
}

/// A direction for a group that survived.
template <class Batch, int N, class Kernel>
void draw(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
          const Uniform4& u, float survival, bool two_photons) {
  const TracingOptions& options = batch.options;
  const KernelNumbers numbers{u[3], u[0], u[1], halves(options, group)};
  if (group.mis.technique == MisTechnique::kLights) {
    pass_on(batch, group, vertex, kernel, numbers, survival);
  } else if (!batch.kAdjoint || options.estimator == Estimator::kTwoPhotons || !kernel.smooth()) {
    draw_from_kernel(batch, group, vertex, kernel, numbers, survival, two_photons);
  } else if (options.estimator == Estimator::kSplit && group.depth <= options.split_vertices) {
    split(batch, group, vertex, kernel, numbers, survival);
  } else {
    // The rest of the number, once divided by the survival probability, is uniform again.
    draw_from_mixture(batch, group, vertex, kernel, numbers, u[2] / survival, survival);
  }
}

template <class Batch, int N, class Bound>
void draw_all(Batch& batch, Chunk<N, Bound>& chunk) {
  std::array<std::uint32_t, kChunk> left;
  std::size_t survivors = 0;
  for (std::uint32_t i = 0; i < chunk.count; ++i) {  // without a jump that nobody can foresee
    left[survivors] = i;
    survivors += chunk.numbers[i][2] < chunk.survival[i] ? 1 : 0;
  }
  for (std::size_t k = 0; k < survivors; ++k) {
    const std::size_t i = left[k];
    draw(batch, *chunk.groups[i], *chunk.vertices[i], *chunk.kernels[i], chunk.numbers[i],
         chunk.survival[i], chunk.two_photons[i]);
  }
}

template <class Batch, int N, class Bound>
void scatter_chunk(Batch& batch, Chunk<N, Bound>& chunk) {
  prepare(batch, chunk);
  if constexpr (Batch::kAdjoint) {
    estimate_next_events(batch, chunk);
  } else if constexpr (Batch::kToCamera) {
    for (std::size_t i = 0; i < chunk.count; ++i) {
      const Vertex<N>& vertex = *chunk.vertices[i];
      if (chunk.met[i]->connected_in_media && batch.is_medium(vertex.hit)) continue;
      connect_to_camera(batch, *chunk.groups[i], vertex, *chunk.kernels[i]);
    }
  }
  draw_all(batch, chunk);
}

/// Those whose kernels are of one type; `which` are indices of groups.
template <class Kernel, int N, class Estimator, bool Media>
void scatter_by(Batch<N, Estimator, Media>& batch, std::span<const std::uint32_t> which) {
  Chunk<N, BoundOf<Kernel, N>> chunk;
  for (const std::uint32_t i : which) {
    add_vertex<Kernel>(batch, i, chunk);
    if (chunk.count < kChunk) continue;
    scatter_chunk(batch, chunk);
    chunk.count = 0;
  }
  if (chunk.count > 0) scatter_chunk(batch, chunk);
}

template <int N, class Estimator, bool Media>
void scatter(Batch<N, Estimator, Media>& batch) {
  const Scene& scene = batch.scene;
  batch.by_kernel.sort(batch.groups.size(), [&](std::size_t i) -> const AnyKernel* {
    if (batch.encounters[i].ended) return nullptr;
    return &scene.kernels[kernel_at(scene, *batch.hits[i], batch.groups[i].ray.direction)];
  });
  for_each_kernel_type([&]<class Kernel>(std::size_t type) {
    const auto which = batch.by_kernel.of(type);
    if (!which.empty()) scatter_by<Kernel>(batch, which);
  });
}

}  // namespace nocturne

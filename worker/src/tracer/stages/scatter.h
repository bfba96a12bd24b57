// Stage: what groups do at a surface or in a medium. The kernel is bound to the vertex once;
// photons go towards lights, roulette decides, and directions are drawn.
#pragma once

#include "tracer/stages/connect.h"
#include "tracer/stages/next_event.h"

namespace nocturne {

/// Inside a body radiance is n^2 times what it is outside, and the photon's weight as much less: it
/// is worth what it will be outside.
template <class Batch, int N>
Spectral<N> square_of_index(const Batch& batch, const Group<N>& group) {
  const std::uint32_t body = group.inside.current(batch.scene.medium_interfaces);
  if (body == InteriorList::kOutside) return 1.0f;
  const Spectral<N> n =
      batch.scene.medium_interfaces[body].index(batch.sample_of(group).wavelengths);
  return n * n;
}

/// In fog without end that absorbs little, photons would wander for ever. From a distance r one
/// flight meets a ball of radius R with (R / r)^2, and a long walk with R / r. At the latter its
/// expected length were endless still, as a walk to r takes r^2 flights.
template <class Batch, int N>
float chance_to_stay(const Batch& batch, const Group<N>& group, Vec3 position) {
  const auto& [centre, radius] = *batch.scene.all_in_fog;
  const Vec3 away = position - centre;
  return std::min(1.0f, largest(group.weight) * radius * radius / dot(away, away));
}

/// What ends photons that roulette by albedo would not, whatever their number of surfaces.
template <int N>
float survival_of_many(const Group<N>& group) {
  const std::uint32_t surfaces = group.depth - group.collisions;
  const float of_caught =
      group.caught > TracingOptions::kCaughtAfter ? TracingOptions::kSurvivalOfCaught : 1.0f;
  return surfaces > TracingOptions::kManyBounces
             ? std::min(of_caught, 1.0f - 2.0f / static_cast<float>(surfaces))
             : of_caught;
}

/// The paper's survival probability is H h. Times the weight that the photon carries, light photons
/// die and heavy ones stay (docs/decisions/0004-roulette-by-weight.md). One probability for the
/// group: it stays together as long as one of them is worth it.
template <class Batch, int N, class Kernel>
float survival_at(const Batch& batch, Group<N>& group, const Vertex<N>& vertex,
                  const Kernel& kernel) {
  constexpr float kClear = 1.0f - 1e-6f;
  const TracingOptions& options = batch.options;
  float survival = 1.0f;
  if (group.depth > options.roulette_after) {
    Spectral<N> albedo = kernel.albedo(vertex.wo);
    group.caught = !kernel.smooth() && largest(albedo) >= kClear ? group.caught + 1 : 0;
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

template <class Batch, int N, class Kernel>
void scatter_adjoint(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel) {
  if (group.mis.technique == MisTechnique::kLights) return pass_on(batch, group, vertex, kernel);
  const TracingOptions& options = batch.options;
  const Uniform4 u = group.sequence.next();
  const float survival = survival_at(batch, group, vertex, kernel);
  const KernelNumbers numbers{u[3], u[0], u[1]};
  const bool two_photons = options.estimator == Estimator::kTwoPhotons && kernel.smooth() &&
                           !batch.scene.lights.empty() && may_see_lights(batch, group, vertex);
  if (two_photons) estimate_next_event(batch, group, vertex, kernel, survival);
  if (u[2] >= survival) return;
  if (options.estimator == Estimator::kTwoPhotons || !kernel.smooth()) {
    draw_from_kernel(batch, group, vertex, kernel, numbers, survival, two_photons);
  } else if (options.estimator == Estimator::kSplit && group.depth <= options.split_vertices) {
    split(batch, group, vertex, kernel, numbers, survival);
  } else {
    // What is left of the number is uniform once more.
    draw_from_mixture(batch, group, vertex, kernel, numbers, u[2] / survival, survival);
  }
}

template <class Batch, int N, class Kernel>
void scatter_forward(Batch& batch, Group<N>& group, const Encounter& met, const Vertex<N>& vertex,
                     const Kernel& kernel) {
  const Uniform4 u = group.sequence.next();
  const float survival = survival_at(batch, group, vertex, kernel);
  if constexpr (Batch::kToCamera) {
    if (!(met.connected_in_media && batch.is_medium(vertex.hit))) {
      connect_to_camera(batch, group, vertex, kernel);
    }
  }
  if (u[2] >= survival) return;
  draw_from_kernel(batch, group, vertex, kernel, {u[3], u[0], u[1]}, survival, false);
}

template <int N, class Estimator, bool Media>
void scatter(Batch<N, Estimator, Media>& batch) {
  const Scene& scene = batch.scene;
  const Contacts none;
  for (std::size_t i = 0; i < batch.groups.size(); ++i) {
    const Encounter& met = batch.encounters[i];
    if (met.ended) continue;
    Group<N>& group = batch.groups[i];
    const Hit& hit = *batch.hits[i];
    const BatchSample<N>& sample = batch.sample_of(group);
    const Contacts& contacts =
        met.contacts == Encounter::kNoContacts ? none : batch.contacts[met.contacts];
    const auto vertex = make_vertex(scene, hit, contacts, group, sample.wavelengths, sample.time,
                                    Estimator::kTransport);
    if (!vertex) {
      pass_index_matched(scene, group, hit, contacts, sample.time);
      batch.next.push_back(group);
      continue;
    }
    // At the limit light still goes straight on, which does not count.
    if (group.depth++ - group.passes == batch.options.max_depth &&
        !scene.materials[hit.surface].has_delta_lobe) {
      continue;
    }
    visit_bound<N>(scene.kernels, vertex->kernel, vertex->shading, [&](const auto& kernel) {
      if constexpr (Batch<N, Estimator, Media>::kAdjoint) {
        scatter_adjoint(batch, group, *vertex, kernel);
      } else {
        scatter_forward(batch, group, met, *vertex, kernel);
      }
    });
  }
}

}  // namespace nocturne

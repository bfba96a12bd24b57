// The photon loop, for both directions: from the sensor to the luminaires, counting light, and from
// the luminaires to the sensor, counting the sensors that meet it. Morley et al., "Image Synthesis
// using Adjoint Photons", GI 2006, sections 2 to 4; in stages over a batch of photons: Laine,
// Karras and Aila, "Megakernels Considered Harmful", HPG 2013; docs/decisions/0038. This file is
// long because all stages are here, in the order in which they run.
//
// Photons of one group share their numbers, and so every decision that does not depend on the
// wavelength; where one differs they part and go on as separate groups. The outcome of a group does
// not depend on the others of its batch.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

#include "math/in_place.h"
#include "pdfs/directions.h"
#include "tracer/both_directions/connections.h"
#include "tracer/sharing/share.h"
#include "tracer/vertex/fluorescence.h"
#include "tracer/vertex/mixture.h"
#include "tracer/vertex/next_event.h"
#include "tracer/vertex/roulette.h"

namespace nocturne {

/// Follows all groups of a batch until they are absorbed, out of the scene, or at the limit of
/// rays. Throws TracingStopped.
template <int N, class Estimator, bool Media>
void trace_batch(Batch<N, Estimator, Media>& batch) {
  for (std::uint32_t rays = 0; !batch.groups.empty(); ++rays) {
    batch.limits.check_stop();
    if (rays == PathLimits::kMaxRays) {
      batch.truncate();
      break;
    }
    intersect(batch);                          // the nearest surface
    if constexpr (Media) sample_media(batch);  // media before it: which are met, what passes
    accumulate_emission(batch);                // light that is met, with its MIS weight
    scatter(batch);  // kernels: next event estimation, roulette, directions
    connect(batch);  // to lights and to the camera, where the way is free
    batch.groups.swap(batch.next);
    batch.next.clear();
  }
  if constexpr (Batch<N, Estimator, Media>::kAdjoint) share(batch);  // sharing/share.h
}

/// Adds one sample, a group of photons, to a batch. Samples are numbered in the order in which they
/// are added.
template <int N, class Estimator, bool Media>
void start(Batch<N, Estimator, Media>& batch, const Start<N>& from,
           const PhotonSequence& sequence) {
  const auto number = static_cast<std::uint32_t>(batch.samples.size());
  BatchSample<N>& sample = batch.samples.emplace_back();
  sample.wavelengths = from.wavelengths;
  sample.time = from.time;
  sample.spread = from.spread;
  sample.flux = from.flux;
  sample.light_group = from.light_group;
  if constexpr (Media) batch.flights.emplace_back(batch.scene, from.wavelengths, batch.limits);
  start_polarisation(batch, from, number);
  if (!(largest(from.flux) > 0.0f)) return;  // nothing was emitted
  Group<N>& group = batch.groups.emplace_back(from, sequence);
  group.sample = group.tally = number;
  if constexpr (Batch<N, Estimator, Media>::kAdjoint) {
    if (from.film_normal) start_towards_lights(batch, *from.film_normal);
  } else {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    group.mis.context.position = from.distant ? Vec3{kFar, kFar, kFar} : from.ray.origin;
  }
}

/// The nearest surface on the ray of each group.
template <int N, class Estimator, bool Media>
void intersect(Batch<N, Estimator, Media>& batch) {
  batch.rays += batch.groups.size();
  batch.timed_rays.clear();
  for (const Group<N>& group : batch.groups) {
    batch.timed_rays.push_back(
        {.ray = group.ray, .time = batch.sample_of(group).time, .departure = &group.departure});
  }
  batch.hits.resize(batch.groups.size());
  batch.scene.geometry.intersect(batch.timed_rays, batch.hits);
  if (!batch.scene.interiors.empty()) {
    for (std::size_t i = 0; i < batch.groups.size(); ++i) {
      InteriorList& inside = batch.groups[i].inside;
      if (batch.hits[i] || inside.empty()) continue;
      inside = inside.without_closed(batch.scene.interiors);
    }
  }
  batch.encounters.assign(batch.groups.size(), {});
}

/// Media up to the nearest surface, if there is one. A medium that is met takes its place.
template <int N, class Estimator>
void sample_media(Batch<N, Estimator, true>& batch) {
  const std::size_t groups = batch.groups.size();  // those that collide surely are added behind
  for (std::size_t i = 0; i < groups; ++i) {
    if constexpr (Batch<N, Estimator, true>::kToCamera) {
      // So that they stay few. A flight is about one group at a time: not in the middle of one.
      if (batch.camera_rays.size() >= kBatchGroups) follow_to_camera(batch);
    }
    Group<N>& group = batch.groups[i];
    std::optional<Hit>& hit = batch.hits[i];
    FreeFlight<N>& flight = batch.flight_of(group);
    if (!flight.enter(group.inside)) continue;
    const float end = hit ? hit->distance : std::numeric_limits<float>::max();
    if constexpr (Batch<N, Estimator, true>::kToCamera) {
      if (group.ends.specular_like_at_luminaire && flight.thin(group, end)) {
        batch.encounters[i].connected_in_media = true;
        connect_from_thin_media(batch, group, end);
      }
    }
    if (group.mis.technique == MisTechnique::kLights) {
      flight.pass(group, end);
    } else if (batch.kAdjoint && group.depth == 0 &&
               batch.options.estimator == nocturne::Estimator::kTwoPhotons &&
               flight.thin(group, end)) {
      // A sensor's photons meet thin media and the surfaces behind them, too: one group collides,
      // the other passes, and each carries its part.
      Group<N> met = group;
      const auto surely = collide_surely(batch, met, end);
      flight.pass(group, end);
      if (surely) {
        batch.groups.push_back(met);
        batch.hits.push_back(surely);
        batch.encounters.emplace_back();
      }
    } else if (const auto collision = flight.collide(group, end)) {
      hit = collision;
      ++group.collisions;
    }
  }
}

/// Most photons that went towards lights end without another look at the surface.
template <class Batch, int N>
bool ends_here(const Batch& batch, const Group<N>& group, const Hit& hit) {
  return group.mis.technique == MisTechnique::kLights &&
         (batch.shadow_rays_suffice || !batch.scene.materials[hit.surface].has_delta_lobe);
}

// Data far away in memory are requested so many groups before they are counted.
inline constexpr std::size_t kAhead = 8;

/// Groups arrive, weakened by the media they crossed, and the light they meet is counted.
template <int N, class Estimator, bool Media>
void accumulate_emission(Batch<N, Estimator, Media>& batch) {
  constexpr bool kAdjoint = Batch<N, Estimator, Media>::kAdjoint;
  batch.contacts.clear();
  std::array<LightSampler::SkyTexel, kAhead> places;
  const auto prefetch = [&](std::size_t i) {
    const auto& environment = batch.scene.lights.environment();
    if (!kAdjoint || !environment || i >= batch.groups.size() || batch.hits[i]) return;
    places[i % kAhead] = environment->prefetch(batch.groups[i].ray.direction);
  };
  for (std::size_t i = 0; i < kAhead; ++i) prefetch(i);
  for (std::size_t i = 0; i < batch.groups.size(); ++i) {
    Group<N>& group = batch.groups[i];
    Encounter& met = batch.encounters[i];
    std::optional<Hit>& hit = batch.hits[i];
    const BatchSample<N>& sample = batch.sample_of(group);
    if (hit) {
      const Contacts touching =
          contacts_of(batch.scene, group.ray, sample.time, group.departure, *hit);
      if (!touching.empty()) {
        met.contacts = static_cast<std::uint32_t>(batch.contacts.size());
        batch.contacts.push_back(touching);
      }
    }
    if constexpr (kAdjoint) {
      batch.estimator.on_ray(sample, group, hit ? &*hit : nullptr, places[i % kAhead]);
    } else {
      batch.estimator.on_ray(sample, group, hit ? &*hit : nullptr);
    }
    prefetch(i + kAhead);
    if (hit) arrive(batch, group, *hit);
    met.ended = !hit || ends_here(batch, group, *hit);
  }
}

/// What groups do at a surface or in a medium. The kernel is bound to the vertex once; photons go
/// towards lights, roulette decides, and directions are drawn.
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
  if constexpr (std::is_same_v<Kernel, FluorescentPhase>) scatter_emitted(batch, chunk);
}

/// Photons that dyes emitted, evenly to all sides.
template <class Batch, int N>
void scatter_emitted(Batch& batch, Chunk<N, BoundFluorescentPhase<N>>& chunk) {
  static constexpr Encounter kMet;
  chunk.count = 0;
  for (EmittedInMedium<N>& from : batch.emitted) {
    const BatchSample<N>& sample = batch.sample_of(from.group);
    auto& vertex = chunk.vertices[chunk.count];
    vertex.emplace(InPlace{[&] {
      return vertex_at(batch.scene, from.hit, from.group, sample.wavelengths, Batch::kTransport);
    }});
    complete(batch.scene, {}, from.group, sample.time, *vertex);
    chunk.groups[chunk.count] = &from.group;
    chunk.met[chunk.count] = &kMet;
    chunk.kernels[chunk.count].emplace(
        BoundFluorescentPhase<N>{BoundPhase<N>(1.0f, HenyeyGreenstein(0.0))});
    if (++chunk.count < kChunk) continue;
    scatter_chunk(batch, chunk);
    chunk.count = 0;
  }
  if (chunk.count > 0) scatter_chunk(batch, chunk);
  batch.emitted.clear();
}

/// Adds what a group met to the chunk, unless it ends or passes there.
template <class Kernel, class Batch, int N, class Bound>
void add_vertex(Batch& batch, std::size_t i, Chunk<N, Bound>& chunk) {
  const Contacts none;
  const Encounter& met = batch.encounters[i];
  Group<N>& group = batch.groups[i];
  const Hit& hit = *batch.hits[i];
  const BatchSample<N>& sample = batch.sample_of(group);
  const Contacts& contacts =
      met.contacts == Encounter::kNoContacts ? none : batch.contacts[met.contacts];
  if (Batch::kAdjoint && sees_past(group, batch.scene.hidden_from(hit.surface))) {
    pass_index_matched(batch.scene, group, hit, contacts, sample.time);
    batch.next.push_back(group);
    return;
  }
  auto& vertex = chunk.vertices[chunk.count];
  vertex.emplace(InPlace{
      [&] { return vertex_at(batch.scene, hit, group, sample.wavelengths, Batch::kTransport); }});
  if (!complete(batch.scene, contacts, group, sample.time, *vertex)) {
    pass_index_matched(batch.scene, group, hit, contacts, sample.time);
    group.shares = false;
    batch.next.push_back(group);
    return;
  }
  // At the limit light still goes straight on, which does not count.
  if (group.depth++ - group.passes == batch.options.max_depth &&
      !batch.scene.materials[hit.surface].has_delta_lobe) {
    return;
  }
  chunk.groups[chunk.count] = &group;
  chunk.met[chunk.count] = &met;
  const Kernel& kernel = *std::get_if<Kernel>(&batch.scene.kernels[vertex->kernel]);
  chunk.kernels[chunk.count].emplace(
      InPlace{[&] { return bind_at(batch, group, *vertex, kernel); }});
  ++chunk.count;
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
    if (Batch::kAdjoint && scatters && !kernel.transmits() && !batch.is_medium(vertex.hit)) {
      vertex.visible_sky =
          batch.scene.lights.visible_sky().find(vertex.hit.position, vertex.normal);
    }
    chunk.two_photons[i] = second && scatters && may_see_lights(batch, group, vertex);
    if constexpr (Batch::kAdjoint) {
      if (group.shares) record_second_vertex(batch, group, vertex, kernel);
      group.shares = false;
    }
    chunk.survival[i] = passes_on ? survival_of_passing(batch, group, vertex, kernel)
                                  : survival_at(batch, group, vertex, kernel);
    sequences[i] = &group.sequence;
    if constexpr (Batch::kAdjoint) {
      if (batch.sharing.on() && chunk.two_photons[i] && group.depth == 1 && group.passes == 0 &&
          record_first_vertex(batch, group, vertex, kernel, chunk.survival[i])) {
        group.sequence.skip(1);
        sequences[i] = &batch.sharing.sequences[group.sample];
      }
    }
  }
  PhotonSequence::next_of_each(
      chunk.count, [&](std::size_t i) -> PhotonSequence& { return *sequences[i]; },
      chunk.numbers.data());
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

/// A direction for a group that survived.
template <class Batch, int N, class Kernel>
void draw(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
          const Uniform4& u, float survival, bool two_photons) {
  const TracingOptions& options = batch.options;
  const KernelNumbers numbers{u[3], u[0], u[1], halves(options, group)};
  if (group.mis.technique == MisTechnique::kLights) {
    continue_through_specular(batch, group, vertex, kernel, numbers, survival);
  } else if (!batch.kAdjoint || options.estimator == Estimator::kTwoPhotons || !kernel.smooth()) {
    draw_from_kernel(batch, group, vertex, kernel, numbers, survival, two_photons);
  } else if (options.estimator == Estimator::kSplit && group.depth <= options.split_vertices) {
    split(batch, group, vertex, kernel, numbers, survival);
  } else {
    // The rest of the number, once divided by the survival probability, is uniform again.
    draw_from_mixture(batch, group, vertex, kernel, numbers, u[2] / survival, survival);
  }
}

/// Vertices of adjoint photons to lights, where nothing is between.
template <class Batch>
void connect_to_lights(Batch& batch) {
  batch.rays += batch.shadow_rays.size();
  batch.timed_rays.clear();
  for (const auto& shadow : batch.shadow_rays) batch.timed_rays.push_back(shadow.way);
  batch.blocked.resize(batch.shadow_rays.size());
  batch.scene.geometry.occluded(batch.timed_rays, batch.blocked);
  for (std::size_t i = 0; i < batch.shadow_rays.size(); ++i) {
    if (batch.blocked[i] == 0) {
      const auto& shadow = batch.shadow_rays[i];
      batch.estimator.add(shadow.tally, shadow.light, shadow.direct);
    }
  }
  for (const auto& part : batch.shadow_lights) {
    if (batch.blocked[part.ray] != 0) continue;
    batch.estimator.add_of_group(batch.shadow_rays[part.ray].tally, part.light_group, part.light);
  }
  batch.shadow_rays.clear();
  batch.shadow_lights.clear();
}

/// Connections between vertices known at both ends.
template <int N, class Estimator, bool Media>
void connect(Batch<N, Estimator, Media>& batch) {
  if constexpr (Batch<N, Estimator, Media>::kAdjoint) {
    connect_to_lights(batch);
  } else if constexpr (Batch<N, Estimator, Media>::kToCamera) {
    follow_to_camera(batch);
  }
}

}  // namespace nocturne

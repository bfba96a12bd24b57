// Vertices whose kernels are of one type, some dozens at a time. Each step of scattering is a short
// loop over them: while one waits for a result, the processor works on the next.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "math/in_place.h"
#include "tracer/stages/travel.h"
#include "tracer/vertex.h"

namespace nocturne {

/// So many that the steps are worth a loop, so few that all of it stays near the processor.
inline constexpr std::size_t kChunk = 32;

template <int N, class Bound>
struct Chunk {
  std::size_t count = 0;
  std::array<Group<N>*, kChunk> groups;
  std::array<const Encounter*, kChunk> met;
  std::array<std::optional<Vertex<N>>, kChunk> vertices;
  std::array<std::optional<Bound>, kChunk> kernels;
  /// The next of each group.
  std::array<Uniform4, kChunk> numbers;
  std::array<float, kChunk> survival;
  /// A second photon goes towards lights.
  std::array<bool, kChunk> two_photons;
};

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
      InPlace{[&] { return bind_kernel(kernel, batch.scene.kernels, vertex->shading); }});
  ++chunk.count;
}

}  // namespace nocturne

// Stage: media up to the nearest surface, if there is one. A medium that is met takes its place.
#pragma once

#include <limits>

#include "tracer/stages/connect.h"

namespace nocturne {

/// A copy of a group that collides in thin media, its weight being the probability of that; empty
/// where there is nothing to meet. To be asked after FreeFlight::thin.
template <int N, class Batch>
std::optional<Hit> collide_surely(Batch& batch, Group<N>& met, float end,
                                  typename FreeFlight<N>::OneOf which = {}) {
  met.sequence = met.sequence.branch(2 + 2 * which.index);
  const auto hit = batch.flight_of(met).force(met, end, which);
  if (!hit || !(largest(met.weight) > 0.0f)) return std::nullopt;
  ++met.collisions;
  return hit;
}

/// From one place of several.
template <int N, class Batch>
void connect_from_media(Batch& batch, const Group<N>& group, float end,
                        typename FreeFlight<N>::OneOf which) {
  Group<N> met = group;
  const auto hit = collide_surely(batch, met, end, which);
  if (!hit) return;
  arrive(batch, met, *hit);
  if (met.depth++ - met.passes == batch.options.max_depth) return;
  const BatchSample<N>& sample = batch.sample_of(met);
  const auto vertex =
      make_vertex(batch.scene, *hit, {}, met, sample.wavelengths, sample.time, Transport::kForward);
  visit_bound<N>(batch.scene.kernels, vertex->kernel, vertex->shading,
                 [&](const auto& kernel) { connect_to_camera(batch, met, *vertex, kernel); });
}

/// To the camera from thin media without waiting for a collision there, which would seldom be; from
/// several places, as the flight there cost more than the rays to the camera (docs/decisions/0102).
template <int N, class Batch>
void connect_from_thin_media(Batch& batch, const Group<N>& group, float end) {
  const std::uint32_t count = batch.flight_of(group).collisions_worthwhile();
  for (std::uint32_t i = 0; i < count; ++i) connect_from_media(batch, group, end, {i, count});
}

template <int N, class Estimator>
void fly(Batch<N, Estimator, true>& batch) {
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

}  // namespace nocturne

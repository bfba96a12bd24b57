// Photons from luminaires are connected to the camera, from surfaces and from thin media, unless
// something is in between.
#pragma once

#include <numeric>

#include "tracer/vertex/travel.h"

namespace nocturne {

/// From a vertex, if the light along this connection belongs to forward photons.
template <class Batch, int N, class Kernel>
void connect_to_camera(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                       const Kernel& kernel) {
  const bool diffuse_like = !batch.scene.specular_like[vertex.kernel] && kernel.smooth() &&
                            !near_camera(batch, group, vertex);
  const PathEnds ends{.diffuse_like_at_camera = diffuse_like,
                      .specular_like_at_luminaire = group.ends.specular_like_at_luminaire};
  if (owner_of(ends) != Transport::kForward) return;
  // The camera sees past a lamp that is hidden from it, and past what its surface reflects.
  if (batch.scene.hidden_from(vertex.hit.surface) != HiddenFrom::kNobody) return;
  PhotonSequence sequence = group.sequence.branch(1);
  const Uniform4 u = sequence.next();
  const auto connection =
      batch.estimator.connect(batch.sample_of(group), vertex.hit.position, u[0], u[1]);
  if (!connection) return;
  const Vec3 wi = vertex.to_local(connection->direction);
  if (wi.z <= 0.0f && !kernel.transmits()) return;
  Group<N> photon = group;
  photon.sequence = sequence;
  photon.weight *= kernel.value(vertex.wo, wi);
  if (!leave(batch, photon, vertex, wi, false)) return;
  batch.camera_rays.push_back({photon, *connection, connection->distance});
}

/// To the end of one ray: the camera, or a surface in front of it.
template <class Batch, int N>
void arrive_towards_camera(Batch& batch, CameraRay<N>& to_camera, std::optional<Hit>& hit) {
  using State = typename CameraRay<N>::State;
  Group<N>& group = to_camera.group;
  const BatchSample<N>& sample = batch.sample_of(group);
  if (hit && hit->distance >= to_camera.left) hit.reset();
  const float end = hit ? hit->distance : to_camera.left;
  if (!batch.flights.empty()) {
    FreeFlight<N>& flight = batch.flight_of(group);
    if (flight.enter(group.inside)) flight.pass(group, end);
  }
  if (!group.inside.empty()) {
    absorb(batch, group, hit ? way_to(group, *hit) : to_camera.left + group.ray_offset);
  }
  if (!hit) {
    to_camera.state = State::kThere;
    return;
  }
  const Contacts contacts = contacts_of(batch.scene, group.ray, sample.time, group.departure, *hit);
  if (batch.scene.hidden_from(hit->surface) == HiddenFrom::kNobody &&
      make_vertex(batch.scene, *hit, contacts, group, sample.wavelengths, sample.time,
                  Transport::kForward)) {
    to_camera.state = State::kHidden;
    return;
  }
  pass_index_matched(batch.scene, group, *hit, contacts, sample.time);
  to_camera.left -= hit->distance;
}

/// All that were connected, ray by ray; they are counted in the order in which they were.
template <class Batch>
void follow_to_camera(Batch& batch) {
  using State = typename decltype(batch.camera_rays)::value_type::State;
  batch.under_way.resize(batch.camera_rays.size());
  std::iota(batch.under_way.begin(), batch.under_way.end(), 0u);
  while (!batch.under_way.empty()) {
    batch.limits.check_stop();
    batch.rays += batch.under_way.size();
    batch.timed_rays.clear();
    for (const std::uint32_t i : batch.under_way) {
      const auto& [group, connection, left, state] = batch.camera_rays[i];
      batch.timed_rays.push_back({.ray = group.ray,
                                  .time = batch.sample_of(group).time,
                                  .end = left,
                                  .departure = &group.departure});
    }
    batch.camera_hits.resize(batch.under_way.size());
    batch.scene.geometry.intersect(batch.timed_rays, batch.camera_hits);
    for (std::size_t k = 0; k < batch.under_way.size(); ++k) {
      arrive_towards_camera(batch, batch.camera_rays[batch.under_way[k]], batch.camera_hits[k]);
    }
    std::erase_if(batch.under_way,
                  [&](std::uint32_t i) { return batch.camera_rays[i].state != State::kUnderWay; });
  }
  for (const auto& [group, connection, left, state] : batch.camera_rays) {
    if (state == State::kThere) {
      batch.estimator.on_camera_connection(batch.sample_of(group), group, connection);
    }
  }
  batch.camera_rays.clear();
}

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

}  // namespace nocturne

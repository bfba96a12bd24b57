// Stage: connections between vertices known at both ends. Photons from luminaires are connected to
// the camera, and vertices of adjoint photons to lights, unless something is in between.
#pragma once

#include <numeric>

#include "tracer/stages/count.h"
#include "tracer/stages/leave.h"

namespace nocturne {

/// From a vertex, if the light along this connection belongs to forward photons.
template <class Batch, int N, class Kernel>
void connect_to_camera(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                       const Kernel& kernel) {
  const bool diffuse_like = !batch.scene.specular_like[vertex.kernel] && kernel.smooth() &&
                            !near_camera(batch, group, vertex);
  const PathEnds ends{.diffuse_like_at_camera = diffuse_like,
                      .specular_like_at_luminaire = group.ends.specular_like_at_luminaire};
  if (brought_by(ends) != Transport::kForward) return;
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
    absorb(batch, group, hit ? way_to(group, *hit) : to_camera.left + group.skipped);
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
      batch.estimator.reaches(batch.sample_of(group), group, connection);
    }
  }
  batch.camera_rays.clear();
}

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
  batch.shadow_rays.clear();
}

template <int N, class Estimator, bool Media>
void connect(Batch<N, Estimator, Media>& batch) {
  if constexpr (Batch<N, Estimator, Media>::kAdjoint) {
    connect_to_lights(batch);
  } else if constexpr (Batch<N, Estimator, Media>::kToCamera) {
    follow_to_camera(batch);
  }
}

}  // namespace nocturne

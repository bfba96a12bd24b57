// From one vertex to the next: leaving a surface or a medium, what bodies absorb on the way, and
// arriving. Index-matched boundaries are passed.
#pragma once

#include <cmath>

#include "tracer/batch.h"
#include "tracer/both_directions/near_ends.h"
#include "tracer/vertex/polarise.h"

namespace nocturne {

/// From the surface that a group left. Its ray is the one from there, moved off the surface: how
/// much sooner it meets the next one depends on how that stands, as in a wedge.
template <int N>
float way_to(const Group<N>& group, const Hit& hit) {
  constexpr float kMinCosine = 1e-3f;
  const float cosine = dot(hit.normal, group.ray.direction);
  if (hit.clearance == 0.0f || group.departure.exact || std::fabs(cosine) < kMinCosine)
    return hit.distance + group.ray_offset;
  return std::max(0.0f, hit.distance + dot(group.step, hit.normal) / cosine);
}

/// Inside a body radiance is n^2 times that outside, and the photon's weight as much less: its
/// worth is that which it will have outside.
template <class Batch, int N>
Spectral<N> square_of_index(const Batch& batch, const Group<N>& group) {
  const std::uint32_t body = group.inside.current(batch.scene.interiors);
  if (body == InteriorList::kOutside) return 1.0f;
  const Spectral<N> n = batch.scene.interiors[body].index(batch.sample_of(group).wavelengths);
  return n * n;
}

/// The largest weight of a group, as it will be outside of all bodies.
template <class Batch, int N>
float worth_outside(const Batch& batch, const Group<N>& group) {
  return largest(group.weight * square_of_index(batch, group));
}

/// What the bodies around it leave of a group.
template <int N, class Batch>
void absorb(const Batch& batch, Group<N>& group, float way) {
  group.weight *= batch.scene.transmittance(group.inside, way, batch.sample_of(group).wavelengths);
}

/// Where a collision in a medium is, as exactly as its ray's start; it may be between surfaces that
/// were crossed together where the medium was entered.
template <int N>
DepartingRay depart_in_medium(const Group<N>& group, const Hit& hit, Vec3 direction) {
  DepartingRay from =
      DepartingRay::from(group.departure.start(group.ray) +
                             static_cast<double>(hit.distance) * Double3(group.ray.direction),
                         direction);
  from.departure.surface = group.departure.surface;
  from.departure.instance = group.departure.instance;
  from.departure.primitive = group.departure.primitive;
  from.departure.in_medium = true;
  return from;
}

/// Sends a group on from a hit. What absorbs begins at the surface.
template <int N>
void start_off(const Scene& scene, Group<N>& group, const Hit& hit, Vec3 direction, float time) {
  const bool in_medium = scene.is_medium(hit.surface);
  if (in_medium ? scene.geometry.any_close() : scene.materials[hit.surface].close) {
    const DepartingRay from = in_medium ? depart_in_medium(group, hit, direction)
                                        : scene.geometry.depart(hit, direction, time);
    group.ray = from.ray;
    group.departure = from.departure;
    group.ray_offset = 0.0f;
    group.step = {0.0f, 0.0f, 0.0f};
    return;
  }
  group.ray = {leave_surface(hit, direction), direction};
  group.departure.exact = false;
  group.departure.residual = {0.0f, 0.0f, 0.0f};
  group.departure.surface = Departure::kNothing;
  if (group.inside.empty()) return;
  group.ray_offset = ray_offset(hit, direction);
  group.step = group.ray.origin - hit.position;
}

/// Straight on through a boundary that has no kernel.
template <int N>
void pass_index_matched(const Scene& scene, Group<N>& group, const Hit& hit,
                        const Contacts& contacts, float time) {
  const bool front = dot(hit.normal, group.ray.direction) < 0.0f;
  group.inside = boundary_at(scene, hit, contacts, group.inside, front).beyond;
  start_off(scene, group, hit, group.ray.direction, time);
}

/// Up to a hit.
template <int N, class Batch>
void arrive(Batch& batch, Group<N>& group, const Hit& hit) {
  const BatchSample<N>& sample = batch.sample_of(group);
  if (!group.inside.empty()) absorb(batch, group, way_to(group, hit));
  group.width += sample.spread * hit.distance;
  if (batch.is_medium(hit)) {
    batch.estimator.on_medium_emission(sample, group, hit);
  } else {
    batch.estimator.on_surface(sample, group, hit);
  }
}

template <class Batch, int N>
bool near_camera(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  return near_camera(batch.scene, vertex.hit.position, batch.sample_of(group).time);
}

/// Where the ray of a photon starts that leaves a vertex in `direction`: moved off its surface, by
/// which a thin lamp lies elsewhere than it does from the vertex.
template <class Batch, int N>
Vec3 leaves_from(const Batch& batch, const Vertex<N>& vertex, Vec3 direction) {
  const bool exact =
      batch.is_medium(vertex.hit) ||
      (batch.scene.materials[vertex.hit.surface].close && !batch.shadow_rays_suffice);
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
void spawn_ray(Batch& batch, const Group<N>& group, const Vertex<N>& vertex, Vec3 wi, bool delta,
               const Change& change) {
  Group<N>& on = batch.next.emplace_back(group);
  change(on);
  if (!leave(batch, on, vertex, wi, delta)) batch.next.pop_back();
}

}  // namespace nocturne

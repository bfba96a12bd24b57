// What happens to a group along its ray, apart from media: bodies absorb, index-matched boundaries
// are passed.
#pragma once

#include <cmath>

#include "tracer/batch.h"

namespace nocturne {

/// From the surface that a group left. Its ray is the one from there, moved off the surface: how
/// much sooner it meets the next one depends on how that stands, as in a wedge.
template <int N>
float way_to(const Group<N>& group, const Hit& hit) {
  constexpr float kMinCosine = 1e-3f;
  const float cosine = dot(hit.normal, group.ray.direction);
  if (hit.clearance == 0.0f || group.departure.exact || std::fabs(cosine) < kMinCosine)
    return hit.distance + group.skipped;
  return std::max(0.0f, hit.distance + dot(group.step, hit.normal) / cosine);
}

/// Inside a body radiance is n^2 times that outside, and the photon's weight as much less: its
/// worth is that which it will have outside.
template <class Batch, int N>
Spectral<N> square_of_index(const Batch& batch, const Group<N>& group) {
  const std::uint32_t body = group.inside.current(batch.scene.medium_interfaces);
  if (body == InteriorList::kOutside) return 1.0f;
  const Spectral<N> n =
      batch.scene.medium_interfaces[body].index(batch.sample_of(group).wavelengths);
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
    group.skipped = 0.0f;
    group.step = {0.0f, 0.0f, 0.0f};
    return;
  }
  group.ray = {leave_surface(hit, direction), direction};
  group.departure.exact = false;
  group.departure.residual = {0.0f, 0.0f, 0.0f};
  group.departure.surface = Departure::kNothing;
  if (group.inside.empty()) return;
  group.skipped = way_skipped(hit, direction);
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

}  // namespace nocturne

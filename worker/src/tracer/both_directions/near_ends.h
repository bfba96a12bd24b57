// Places so near to an end of a path that only photons from there find them well: by one over the
// square of the distance the others count by far too much, or come too seldom.
#pragma once

#include "scene/scene.h"
#include "tracer/group.h"

namespace nocturne {

inline bool near_camera(const Scene& scene, Vec3 position, float time) {
  return scene.sensor.distance_from(position, time) < scene.near_ends;
}

/// Of a photon's latest interaction, or its start, and where its straight segment from there ends:
/// one of the two is on a luminaire. Never of distant light.
template <int N>
bool near_luminaire(const Scene& scene, const Group<N>& group, Vec3 end) {
  return length(end - group.mis.context.position) < scene.near_ends;
}

}  // namespace nocturne

// Surfaces that touch. A photon that leaves a hit starts a little off it, and would step over all
// that lies in the same place: glass on a table, water in a glass, two banks of fog side by side.
// So it meets them all at once (docs/decisions/0029-surfaces-that-touch.md).
#pragma once

#include <span>
#include <vector>

#include "math/ray.h"
#include "scene/interior_list.h"
#include "scene/scene.h"
#include "surfaces/geometry.h"

namespace nocturne {

/// Sets `contact_reach` of all materials: of bodies whose box meets another surface's, and of what
/// else photons go through where its box meets a body's. Groups are as Geometry takes them.
void find_contacts(const Geometry& geometry, std::span<const std::uint32_t> groups,
                   std::vector<SurfaceMaterial>& materials);

/// What touches a hit. The hit becomes the one that is seen: a surface that bounds no body hides
/// the bodies' own; of bodies, that of the highest priority.
Contacts search_contacts(const Geometry& geometry, std::span<const SurfaceMaterial> materials,
                         std::span<const MediumInterface> medium_interfaces, const Ray& ray,
                         float time, Hit& hit);

/// Most hits are on surfaces that touch nothing.
inline Contacts contacts_of(const Geometry& geometry, std::span<const SurfaceMaterial> materials,
                            std::span<const MediumInterface> medium_interfaces, const Ray& ray,
                            float time, Hit& hit) {
  if (!(materials[hit.surface].contact_reach > 0.0f)) return {};
  return search_contacts(geometry, materials, medium_interfaces, ray, time, hit);
}
inline Contacts contacts_of(const Scene& scene, const Ray& ray, float time, Hit& hit) {
  return contacts_of(scene.geometry, scene.materials, scene.medium_interfaces, ray, time, hit);
}

}  // namespace nocturne

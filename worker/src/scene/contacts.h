// Surfaces that lie close together, or touch: the two faces of a thin pane, a lamp behind a mask,
// glass on a table, water in a glass. Single precision does not resolve their order: they are met
// in the order that double precision gives (docs/decisions/0053), and those that lie in the same
// place all at once (docs/decisions/0029).
#pragma once

#include <span>
#include <vector>

#include "math/ray.h"
#include "scene/interior_list.h"
#include "scene/scene.h"
#include "surfaces/geometry.h"

namespace nocturne {

/// For Geometry::set_close: surfaces that photons go through and that are close to something, be it
/// to themselves, and the surfaces close to those. Groups are as Geometry takes them;
/// `longest_view` is how far away a hit may be from where its ray starts, m.
std::vector<CloseSurface> find_close(const Geometry& geometry,
                                     std::span<const std::uint32_t> groups,
                                     const std::vector<SurfaceMaterial>& materials,
                                     std::span<const Interior> interiors, float longest_view);

/// What touches a hit. The hit becomes the first of those that are close together; of those that
/// touch, the one that is seen: a surface that bounds no body hides the bodies' own; of bodies,
/// that of the highest priority.
Contacts search_contacts(const Geometry& geometry, std::span<const SurfaceMaterial> materials,
                         std::span<const Interior> interiors, const Ray& ray, float time,
                         const Departure& departure, Hit& hit);

/// Most hits are on surfaces that nothing is close to.
inline Contacts contacts_of(const Geometry& geometry, std::span<const SurfaceMaterial> materials,
                            std::span<const Interior> interiors, const Ray& ray, float time,
                            const Departure& departure, Hit& hit) {
  if (!materials[hit.surface].close) return {};
  return search_contacts(geometry, materials, interiors, ray, time, departure, hit);
}
inline Contacts contacts_of(const Scene& scene, const Ray& ray, float time,
                            const Departure& departure, Hit& hit) {
  return contacts_of(scene.geometry, scene.materials, scene.interiors, ray, time, departure, hit);
}

}  // namespace nocturne

// Searches for rays that depart exactly, where surfaces lie so close together that Embree's single
// precision does not tell their order: Embree offers the primitives nearby, and double precision
// decides.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "surfaces/embree_scene.h"
#include "surfaces/geometry.h"

namespace nocturne {

/// The nearest hit of a ray that departs exactly.
std::optional<Hit> nearest_ahead(const EmbreeScene& scene, const Ray& ray, float time,
                                 const Departure& departure);

/// See Geometry::crossings_near.
std::size_t crossings_near(const EmbreeScene& scene, const Ray& ray, float time,
                           const Departure& departure, const Hit& hit, float reach,
                           std::span<NearCrossing> found);

}  // namespace nocturne

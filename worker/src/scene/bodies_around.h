// The bodies that photons start inside of. Mostly all that start at a sensor, or on one side of a
// luminaire, start inside of the same ones, which are found when the scene is loaded. Where a
// boundary may pass between them, at any time of the shutter, each is asked for by itself.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scene/interior_list.h"
#include "scene/scene.h"
#include "surfaces/box_tree.h"

namespace nocturne {

/// The geometry that can be queried before the scene is made.
struct Bodies {
  const Geometry& geometry;
  std::span<const SurfaceMaterial> materials;
  std::span<const Interior> interiors;
  const InteriorList& everywhere;
};

/// A box that holds a shape at all times, null for one that stands in the scene itself.
Box whole_box_of(const Shape& shape, const PlacedInstance* instance);

/// The bodies around a point: those that are everywhere, and those that a straight line from it
/// leaves.
InteriorList bodies_around(const Bodies& bodies, Vec3 position, float time);
/// The same of a point on a surface, on the side that `towards` points to.
InteriorList bodies_around(const Bodies& bodies, const Hit& on, Vec3 towards, float time);

/// Of a sensor.
SensorSurroundings sensor_surroundings(const Bodies& bodies, std::span<const std::uint32_t> groups,
                                       const Sensor& sensor, Vec3 start);

/// By luminaire.
std::vector<LuminaireSurroundings> luminaire_surroundings(const Bodies& bodies,
                                                          std::span<const std::uint32_t> groups,
                                                          const std::vector<Luminaire>& luminaires);

/// Of a sample that starts at the scene's sensor.
InteriorList bodies_at_sensor(const Scene& scene, Film film, Vec3 start, float time);
/// Of a photon that leaves a luminaire.
InteriorList bodies_at_luminaire(const Scene& scene, std::uint32_t luminaire, const Hit& from,
                                 Vec3 direction, float time);

}  // namespace nocturne

// Where a sensor's samples start, at all times of the shutter; and how far away it sees.
#pragma once

#include <span>
#include <vector>

#include "scene/scene.h"
#include "surfaces/box_tree.h"

namespace nocturne {

/// Boxes that hold all starts, for films that are no more than this many times as wide as high.
inline constexpr std::uint32_t kMaxAspect = 4;
std::vector<Box> boxes_of_starts(const Sensor& sensor);

/// A ball that holds the geometry and, where forward photons are counted on a film, that.
Geometry::Ball ball_with_film(const Geometry::Ball& geometry, const Sensor& sensor, Film film);
inline Geometry::Ball ball_with_film(const Scene& scene, Film film) {
  return ball_with_film(scene.geometry.bounds(), scene.sensor, film);
}

/// Median distance to what a sensor sees through all that light passes, m; infinite where that is
/// nothing.
float median_view(const Sensor& sensor, const Geometry& geometry,
                  std::span<const SurfaceMaterial> materials);

}  // namespace nocturne

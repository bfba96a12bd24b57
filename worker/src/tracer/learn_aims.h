// Learns what photons from luminaires should be aimed at, from some that reached the sensor
// (docs/decisions/0081-learned-aims.md).
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace nocturne {

/// A ball that photons are worth being sent to.
struct Aim {
  Vec3 centre;
  float radius;
  /// Relative to the others, positive.
  double weight;
};

/// At most 16 balls around most of the places that were worth it; none where these are too few to
/// tell. Depends on the order of the places by rounding only.
std::vector<Aim> aims_around(const std::vector<Vec3>& places);

struct LearnedAims {
  std::vector<Aim> aims;
  std::uint64_t photons, rays;
};

/// From about so many groups of photons, none of them aimed, of a scene that is loaded for them:
/// where those first came that left a luminaire and reached the sensor. The same on any number of
/// threads. Random numbers are others than those of a render.
LearnedAims learn_aims(Scene& scene, Film film, double photons, unsigned threads);

}  // namespace nocturne

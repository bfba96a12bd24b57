// Learns from some photons of the luminaires where to aim others
// (docs/decisions/0081-learned-aims.md), and where light comes from that mirrors and glass gather,
// for photons from the sensor to be guided by (docs/decisions/0104-learned-light.md).
#pragma once

#include <cstdint>
#include <vector>

#include "luminaires/learned_light.h"
#include "scene/scene.h"

namespace nocturne {

struct Learned {
  /// Where photons first came that left a luminaire and reached the sensor.
  std::vector<Vec3> worth_aiming_at;
  /// Photons that came to surfaces like diffuse ones, by mirrors and clear glass alone: at most
  /// LearnedLight::kMaxArrivals, spread over all. With both directions only.
  std::vector<LearnedLight::Arrival> arrivals;
  std::uint64_t photons = 0, rays = 0;
};

/// From about so many groups of photons, none of them aimed, of a scene that is loaded for them;
/// nothing where a camera has no mirrors that gather light for it. The same on any number of
/// threads. Random numbers are others than those of a render.
Learned learn(Scene& scene, Film film, double photons, unsigned threads);

}  // namespace nocturne

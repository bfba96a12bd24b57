// Learns where light comes from that mirrors and glass gather, from photons of the luminaires that
// come by these to surfaces (docs/decisions/0104-learned-light.md).
#pragma once

#include <cstdint>
#include <vector>

#include "luminaires/learned_light.h"
#include "scene/scene.h"

namespace nocturne {

struct LearnedArrivals {
  std::vector<LearnedLight::Arrival> arrivals;
  std::uint64_t photons, rays;
};

/// From about so many groups of photons of a scene that is loaded for both directions; at most
/// `most` of what they came to. The same on any number of threads. Random numbers are others than
/// those of a render.
LearnedArrivals learn_light(Scene& scene, double photons, std::size_t most, unsigned threads);

}  // namespace nocturne

// Which numbers a photon from the luminaires has, and how it starts by them.
#pragma once

#include <cstdint>

#include "scene/bodies_around.h"
#include "scene/scene.h"
#include "tracer/group.h"
#include "tracer/joint_sets.h"

namespace nocturne {

/// Those of photon `photon` of all of the film: all, up to 2^32, are points of one sequence, so
/// that they leave the luminaires evenly. With both directions, others than those of photons from
/// the pixels.
inline PixelSequence photon_numbers(const Scene& scene, std::uint64_t photon) {
  const std::uint32_t other = scene.options.direction == Direction::kBoth ? ~0u : 0u;
  return {scene.options.sequence, scene.options.seed,
          static_cast<std::uint32_t>(photon >> 32) ^ other, kJointSetsOfEmission};
}
/// Which point of that sequence it is.
constexpr std::uint32_t sample_of_photon(std::uint64_t photon) {
  return static_cast<std::uint32_t>(photon);
}

template <int N>
struct PhotonStart {
  WavelengthSamples<N> wavelengths;
  /// With flux 0 where none is emitted.
  Start<N> start;
};

/// From the first numbers of its sequence. `lit` holds all that photons are to reach
/// (sensor_extents.h).
template <int N>
PhotonStart<N> start_photon(const Scene& scene, const Geometry::Ball& lit,
                            PhotonSequence& sequence) {
  const Uniform4 u = sequence.next();
  const float time = u[3];
  PhotonStart<N> photon{.wavelengths = scene.wavelengths.template sample<N>(u[2]), .start = {}};
  Start<N>& start = photon.start;
  start.wavelengths = photon.wavelengths.nm;
  const Uniform4 first = sequence.next(), second = sequence.next();
  const auto emitted =
      scene.emitter.emit(scene.luminaires, scene.lights, scene.geometry, lit,
                         scene.options.aimed_emission, time, start.wavelengths, first, second);
  if (!emitted || largest(emitted->radiance) < scene.options.least_radiance) {
    start.flux = 0.0f;
    return photon;
  }
  start.ray = emitted->ray;
  start.departure = emitted->departure;
  start.time = time;
  start.flux = emitted->flux;
  start.light_group = emitted->light_group;
  start.distant = emitted->luminaire == Emitted<N>::kDistant;
  if (emitted->luminaire == Emitted<N>::kRays) {
    start.inside = scene.everywhere;
  } else if (!start.distant) {
    start.inside =
        bodies_at_luminaire(scene, emitted->luminaire, emitted->from, emitted->ray.direction, time);
  }
  return photon;
}

}  // namespace nocturne

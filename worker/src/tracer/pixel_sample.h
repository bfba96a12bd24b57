// A sample of a pixel where it starts: on the sensor.
#pragma once

#include "scene/scene.h"
#include "tracer/group.h"

namespace nocturne {

template <int N>
struct PixelSample {
  WavelengthSamples<N> wavelengths;
  /// Radiance along the ray times this is what the sensor measures.
  float weight;
  Start<N> start;
};

/// Takes the first numbers of `sequence`.
template <int N>
PixelSample<N> sample_pixel(const Scene& scene, Film film, std::uint32_t x, std::uint32_t y,
                            PhotonSequence& sequence) {
  const Uniform4 u = sequence.next();
  const Uniform4 v = scene.sensor.needs_lens() ? sequence.next() : Uniform4{};
  const SensorSample from = scene.sensor.sample(film, static_cast<float>(x) + u[0],
                                                static_cast<float>(y) + u[1], v[0], v[1], u[3]);
  PixelSample<N> sample{scene.wavelengths.sample<N>(u[2]), from.weight, {}};
  sample.start = {from.ray,   {},         sample.wavelengths.nm, scene.sensor_inside, u[3],
                  from.width, from.spread};
  return sample;
}

}  // namespace nocturne

// A sample of a pixel where it starts: on the sensor.
#pragma once

#include "scene/bodies_around.h"
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

/// The first numbers of a sample: where in the pixel, which wavelengths, when, where on the lens.
struct PixelNumbers {
  float x, y, wavelengths, time, lens_u, lens_v;
};
inline std::uint32_t sets_of_pixel(const Scene& scene) { return scene.sensor.needs_lens() ? 2 : 1; }
inline PixelNumbers next_pixel_numbers(const Scene& scene, PhotonSequence& sequence) {
  const Uniform4 u = sequence.next();
  const Uniform4 v = scene.sensor.needs_lens() ? sequence.next() : Uniform4{};
  return {u[0], u[1], u[2], u[3], v[0], v[1]};
}
/// To the number behind them.
inline void skip_pixel_numbers(const Scene& scene, PhotonSequence& sequence) {
  sequence.skip(sets_of_pixel(scene));
}

template <int N>
PixelSample<N> sample_pixel(const Scene& scene, Film film, std::uint32_t x, std::uint32_t y,
                            const PixelNumbers& u, const WavelengthSamples<N>& wavelengths) {
  const SensorSample from =
      scene.sensor.sample_in(film, x, y, u.x, u.y, u.lens_u, u.lens_v, u.time);
  PixelSample<N> sample{wavelengths, from.weight, {}};
  sample.start.ray = from.ray;
  sample.start.wavelengths = sample.wavelengths.nm;
  sample.start.inside = bodies_at_sensor(scene, film, from.ray.origin, u.time);
  sample.start.time = u.time;
  sample.start.width = from.width;
  sample.start.spread = from.spread;
  sample.start.film_normal = from.normal;
  return sample;
}

/// A sample with its own wavelengths.
template <int N>
PixelSample<N> sample_pixel(const Scene& scene, Film film, std::uint32_t x, std::uint32_t y,
                            const PixelNumbers& u) {
  return sample_pixel(scene, film, x, y, u, scene.wavelengths.sample<N>(u.wavelengths));
}

}  // namespace nocturne

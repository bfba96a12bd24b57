#include "tracer/trace_tile.h"

#include <immintrin.h>

#include <cmath>
#include <stdexcept>

#include "tracer/baselines/path_tracer.h"
#include "tracer/baselines/ray_marcher.h"
#include "tracer/trace_forward.h"
#include "tracer/trace_group.h"

namespace nocturne {
namespace {

// Numbers below 1e-38 count as zero while tracing (Embree wants it so); the caller's setting comes
// back afterwards.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushDenormals() { _mm_setcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned before_;
};

// What a group adds to a pixel: the mean over its photons of response x radiance, for X, Y, Z and
// then each further response. Photons that found what is no radiance are left out and counted.
template <int N>
class Response {
 public:
  Response(const WavelengthSampler& sampler, const WavelengthSamples<N>& wavelengths)
      : sampler_(sampler), wavelengths_(wavelengths) {}

  /// Adds `scale` times the response to channels X, Y, Z of `pixel` and to those from kXyzChannels
  /// on; returns the number of photons left out.
  std::uint32_t add(const Spectral<N>& radiance, double scale, double* pixel) const {
    const Kept kept = add_xyz(radiance, scale, pixel);
    for (std::size_t c = 0; c < sampler_.further_curves(); ++c) {
      pixel[TileSums::kXyzChannels + c] +=
          scale * mean(sampler_.further_weight(c, wavelengths_), kept.radiance);
    }
    return kept.invalid_samples;
  }

  struct Kept {
    Spectral<N> radiance;
    std::uint32_t invalid_samples;
  };

  Kept add_xyz(const Spectral<N>& radiance, double scale, double* pixel) const {
    Kept kept{radiance, 0};
    for (std::size_t k = 0; k < N; ++k) {
      if (std::isfinite(radiance[k]) && radiance[k] >= 0.0f) continue;
      kept.radiance[k] = 0.0f;
      ++kept.invalid_samples;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      pixel[c] += scale * mean(wavelengths_.weight[c], kept.radiance);
    }
    return kept;
  }

 private:
  static double mean(const Spectral<N>& weight, const Spectral<N>& radiance) {
    double sum = 0.0;
    for (std::size_t k = 0; k < N; ++k) sum += static_cast<double>(weight[k]) * radiance[k];
    return sum / N;
  }

  const WavelengthSampler& sampler_;
  const WavelengthSamples<N>& wavelengths_;
};

// One sample's values into the sums, and the square of its Y.
void add_sample(const double* sample, std::size_t channels, double* pixel) {
  for (std::size_t c = 0; c < channels; ++c) {
    if (c != 3) pixel[c] += sample[c];
  }
  pixel[3] += sample[1] * sample[1];
}

// A sample of a pixel, a group of N photons, added to `values`; Trace is
// GroupResult<N>(scene, start, sequence).
template <int N, class Trace>
void trace_sample(const Scene& scene, Film film, std::uint32_t x, std::uint32_t y,
                  PhotonSequence sequence, const Trace& trace, TileSums& tile, double* values) {
  const Uniform4 u = sequence.next();
  const Uniform4 v = scene.sensor.needs_lens() ? sequence.next() : Uniform4{};
  const SensorSample from = scene.sensor.sample(film, static_cast<float>(x) + u[0],
                                                static_cast<float>(y) + u[1], v[0], v[1], u[3]);
  const WavelengthSamples<N> wavelengths = scene.wavelengths.sample<N>(u[2]);
  const GroupResult<N> group =
      trace(scene, {from.ray, wavelengths.nm, scene.sensor_inside, u[3], from.width, from.spread},
            sequence);
  tile.rays += group.rays;
  const Response<N> response(scene.wavelengths, wavelengths);
  tile.invalid_samples +=
      tile.channels == TileSums::kXyzChannels
          ? response.add_xyz(group.radiance, from.weight, values).invalid_samples
          : response.add(group.radiance, from.weight, values);
}

template <int N, class Trace>
void trace_pixel(const Scene& scene, Film film, std::uint32_t x, std::uint32_t y,
                 const TileRange& range, const Trace& trace, std::vector<double>& values,
                 TileSums& tile, double* pixel) {
  PixelSequence numbers(scene.options.sequence, scene.options.seed, y * film.width + x);
  for (std::uint32_t sample = range.first_sample; sample < range.end_sample; ++sample) {
    std::fill(values.begin(), values.end(), 0.0);
    trace_sample<N>(scene, film, x, y, PhotonSequence(numbers, sample), trace, tile, values.data());
    add_sample(values.data(), tile.channels, pixel);
  }
}

template <int N, class Trace>
TileSums trace_pixels(const Scene& scene, Film film, const TileRange& range, const Trace& trace) {
  TileSums tile(static_cast<std::size_t>(range.width) * range.height,
                scene.wavelengths.further_curves());
  std::vector<double> values(tile.channels);
  double* pixel = tile.sums.data();
  for (std::uint32_t y = range.y; y < range.y + range.height; ++y) {
    for (std::uint32_t x = range.x; x < range.x + range.width; ++x) {
      trace_pixel<N>(scene, film, x, y, range, trace, values, tile, pixel);
      pixel += tile.channels;
    }
  }
  return tile;
}

// A sample of all pixels at once by photons from the luminaires, as many as the film has pixels,
// added to `values`.
template <int N>
void trace_forward_sample(const Scene& scene, Film film, std::uint32_t sample, TileSums& tile,
                          std::vector<Splat<N>>& splats, std::vector<double>& values) {
  const std::uint32_t pixels = film.width * film.height;
  // Other numbers than those of photons from the pixels.
  const std::uint32_t other = scene.options.direction == Direction::kBoth ? ~0u : 0u;
  for (std::uint32_t photon = 0; photon < pixels; ++photon) {
    PixelSequence photon_sequence(scene.options.sequence, scene.options.seed, photon ^ other);
    PhotonSequence sequence(photon_sequence, sample);
    const Uniform4 u = sequence.next();
    const WavelengthSamples<N> wavelengths = scene.wavelengths.sample<N>(u[2]);
    splats.clear();
    tile.rays += trace_forward<N>(scene, film, u[3], wavelengths.nm, sequence, splats);
    const Response<N> response(scene.wavelengths, wavelengths);
    for (const Splat<N>& splat : splats) {
      tile.invalid_samples +=
          response.add(splat.value, 1.0 / pixels, &values[tile.channels * splat.pixel]);
    }
  }
}

// Forward photons fall anywhere on the film. As many as it has pixels, and with both directions one
// from each pixel, make one sample of the whole image, so that means and errors are those of any
// other image.
template <int N, bool Media>
TileSums trace_whole_film(const Scene& scene, Film film, const TileRange& range) {
  if (range.width != film.width || range.height != film.height) {
    throw std::invalid_argument("a tile with forward photons that is not the whole film");
  }
  TileSums tile(static_cast<std::size_t>(film.width) * film.height,
                scene.wavelengths.further_curves());
  std::vector<double> values(tile.sums.size());
  std::vector<Splat<N>> splats;
  for (std::uint32_t sample = range.first_sample; sample < range.end_sample; ++sample) {
    std::fill(values.begin(), values.end(), 0.0);
    trace_forward_sample<N>(scene, film, sample, tile, splats, values);
    for (std::uint32_t pixel = 0; pixel < film.width * film.height; ++pixel) {
      double* const its = &values[tile.channels * pixel];
      if (scene.options.direction == Direction::kBoth) {
        PixelSequence numbers(scene.options.sequence, scene.options.seed, pixel);
        trace_sample<N>(scene, film, pixel % film.width, pixel / film.width,
                        PhotonSequence(numbers, sample), trace_group<N, Media>, tile, its);
      }
      add_sample(its, tile.channels, &tile.sums[tile.channels * pixel]);
    }
  }
  return tile;
}

template <int N, bool Media>
TileSums trace_by_direction(const Scene& scene, Film film, const TileRange& range) {
  return scene.options.direction == Direction::kAdjoint
             ? trace_pixels<N>(scene, film, range, trace_group<N, Media>)
             : trace_whole_film<N, Media>(scene, film, range);
}

template <int N>
TileSums trace_tile_in_groups(const Scene& scene, Film film, const TileRange& range) {
  return scene.media.empty() ? trace_by_direction<N, false>(scene, film, range)
                             : trace_by_direction<N, true>(scene, film, range);
}

TileSums trace_any(const Scene& scene, Film film, const TileRange& range, Method method) {
  if (method.kind == Method::kRayMarching) {
    const auto march = [&](const Scene& s, const Start<1>& start, const PhotonSequence& sequence) {
      return baselines::march_ray(s, start, sequence, method.steps);
    };
    return trace_pixels<1>(scene, film, range, march);
  }
  if (method.kind == Method::kPathTracing) {
    if (!scene.media.empty()) throw std::invalid_argument("the path tracer knows no media");
    return trace_pixels<1>(scene, film, range, baselines::trace_path);
  }
  switch (scene.options.group) {
    case 4:
      return trace_tile_in_groups<4>(scene, film, range);
    case 8:
      return trace_tile_in_groups<8>(scene, film, range);
    default:
      return trace_tile_in_groups<1>(scene, film, range);
  }
}

}  // namespace

TileSums trace_tile(const Scene& scene, Film film, const TileRange& range, Method method) {
  const FlushDenormals flush;
  TileSums tile = trace_any(scene, film, range, method);
  const std::uint32_t together = method.kind != Method::kAdjointPhotons ? 1 : scene.options.group;
  tile.photons = static_cast<std::uint64_t>(range.width) * range.height *
                 (range.end_sample - range.first_sample) * together;
  return tile;
}

}  // namespace nocturne

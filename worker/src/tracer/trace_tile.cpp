#include "tracer/trace_tile.h"

#include <immintrin.h>

#include <cmath>

#include "tracer/baselines/path_tracer.h"
#include "tracer/trace_photon.h"

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

// Trace is PhotonResult(scene, ray, wavelength, sequence).
template <class Trace>
void trace_pixel(const Scene& scene, Film film, std::uint32_t x, std::uint32_t y,
                 const TileRange& range, const Trace& trace, TileSums& tile, double* pixel) {
  const TracingOptions& options = scene.options;
  const bool lens = scene.camera.lens_radius > 0.0f;
  PixelSequence pixel_sequence(options.sequence, options.seed, y * film.width + x);
  for (std::uint32_t sample = range.first_sample; sample < range.end_sample; ++sample) {
    PhotonSequence sequence(pixel_sequence, sample);
    const Uniform4 u = sequence.next();
    const Uniform4 v = lens ? sequence.next() : Uniform4{};
    const Ray ray = scene.camera.ray(film, static_cast<float>(x) + u[0],
                                     static_cast<float>(y) + u[1], v[0], v[1]);
    const WavelengthSample wavelength = scene.wavelengths.sample(u[2]);
    const PhotonResult photon = trace(scene, ray, wavelength.nm, sequence);
    tile.rays += photon.rays;
    if (!std::isfinite(photon.radiance) || photon.radiance < 0.0f) {
      ++tile.rejected;
      continue;
    }
    const double radiance = photon.radiance;
    const double luminance = wavelength.weight[1] * radiance;
    pixel[0] += wavelength.weight[0] * radiance;
    pixel[1] += luminance;
    pixel[2] += wavelength.weight[2] * radiance;
    pixel[3] += luminance * luminance;
  }
}

template <class Trace>
TileSums trace_pixels(const Scene& scene, Film film, const TileRange& range, const Trace& trace) {
  const FlushDenormals flush;
  TileSums tile(static_cast<std::size_t>(range.width) * range.height);
  double* pixel = tile.sums.data();
  for (std::uint32_t y = range.y; y < range.y + range.height; ++y) {
    for (std::uint32_t x = range.x; x < range.x + range.width; ++x) {
      trace_pixel(scene, film, x, y, range, trace, tile, pixel);
      pixel += TileSums::kChannels;
    }
  }
  tile.photons = static_cast<std::uint64_t>(range.width) * range.height *
                 (range.end_sample - range.first_sample);
  return tile;
}

}  // namespace

TileSums trace_tile(const Scene& scene, Film film, const TileRange& range, Method method) {
  if (method == Method::kPathTracing) {
    return trace_pixels(scene, film, range, baselines::trace_path);
  }
  return trace_pixels(scene, film, range, trace_photon);
}

}  // namespace nocturne

#include "tracer/trace_tile.h"

#include <algorithm>
#include <stdexcept>

#include "tile/block_samples.h"
#include "tracer/baselines/path_tracer.h"
#include "tracer/baselines/ray_marcher.h"
#include "tracer/flush_denormals.h"
#include "tracer/trace_pixels.h"
#include "tracer/trace_whole_film.h"

namespace nocturne {
namespace {

// One sample after the other, for methods that are there for comparison; Trace is
// baselines::PathResult(scene, start, sequence).
template <class Trace>
TileSums trace_alone(const Scene& scene, Film film, const TileRange& range, const Trace& trace) {
  TileSums tile(range.width, range.height, scene.wavelengths.further_curves());
  BlockSamples blocks(tile, range.end_sample - range.first_sample);
  std::vector<double> values(tile.values());
  double* pixel = tile.sums.data();
  for (std::uint32_t y = range.y; y < range.y + range.height; ++y) {
    for (std::uint32_t x = range.x; x < range.x + range.width; ++x, pixel += tile.channels) {
      PixelSequence numbers(scene.options.sequence, scene.options.seed, y * film.width + x);
      for (std::uint32_t sample = range.first_sample; sample < range.end_sample; ++sample) {
        PhotonSequence sequence(numbers, sample);
        const auto from = sample_pixel<1>(scene, film, x, y, next_pixel_numbers(scene, sequence));
        const baselines::PathResult path = trace(scene, from.start, sequence);
        tile.rays += path.rays;
        std::fill(values.begin(), values.end(), 0.0);
        tile.invalid_samples += Response<1>(scene.wavelengths, from.wavelengths)
                                    .add(path.radiance, from.weight, values.data());
        add_sample(values.data(), tile.further, pixel);
        blocks.add(x - range.x, y - range.y, sample - range.first_sample, values.data());
      }
    }
  }
  blocks.add_to(tile);
  return tile;
}

/// Photons of which side are traced.
enum class Side { kBoth, kSensor, kLuminaires };

template <int N, bool Media>
TileSums trace_photons(const Scene& scene, Film film, const TileRange& range, Side side,
                       std::uint32_t groups, const std::stop_token& stop) {
  const Direction direction = scene.options.direction;
  const bool whole_film = range.width == film.width && range.height == film.height;
  // Photons from luminaires come in ranges of their own where the film has several tiles, or where
  // they are not as many as those from pixels.
  const bool apart = side == Side::kBoth && direction == Direction::kBoth &&
                     (!whole_film || scene.options.forward_ratio != 1.0);
  if (side == Side::kSensor || direction == Direction::kAdjoint || apart) {
    return trace_pixels<N, Media>(scene, film, range, groups, stop);
  }
  if (!whole_film) {
    throw std::invalid_argument("a tile with forward photons that is not the whole film");
  }
  const bool from_pixels = side == Side::kBoth && direction == Direction::kBoth;
  const auto trace = [&](auto film_tracer) {
    return film_tracer.trace(range.first_sample, range.end_sample);
  };
  return direction == Direction::kForward
             ? trace(WholeFilm<N, SensorEstimator<N>, Media>(scene, film, groups, false, stop))
             : trace(
                   WholeFilm<N, CameraEstimator<N>, Media>(scene, film, groups, from_pixels, stop));
}

template <int N>
TileSums trace_in_groups(const Scene& scene, Film film, const TileRange& range, Side side,
                         std::uint32_t groups, const std::stop_token& stop) {
  return scene.media.empty() ? trace_photons<N, false>(scene, film, range, side, groups, stop)
                             : trace_photons<N, true>(scene, film, range, side, groups, stop);
}

TileSums trace_side(const Scene& scene, Film film, const TileRange& range, Side side,
                    std::uint32_t groups, const std::stop_token& stop) {
  switch (scene.options.group) {
    case 4:
      return trace_in_groups<4>(scene, film, range, side, groups, stop);
    default:
      return trace_in_groups<1>(scene, film, range, side, groups, stop);
  }
}

TileSums trace_any(const Scene& scene, Film film, const TileRange& range, Method method,
                   std::uint32_t groups, const std::stop_token& stop) {
  if (method.kind == Method::kRayMarching) {
    return trace_alone(scene, film, range, [&](const auto& s, const auto& start, const auto& u) {
      return baselines::march_ray(s, start, u, method.steps);
    });
  }
  if (method.kind == Method::kPathTracing) {
    if (!scene.media.empty()) throw std::invalid_argument("the path tracer knows no media");
    return trace_alone(scene, film, range, baselines::trace_path);
  }
  return trace_side(scene, film, range, Side::kBoth, groups, stop);
}

TileSums counted(TileSums tile, const TileRange& range, std::uint32_t together) {
  tile.photons = static_cast<std::uint64_t>(range.width) * range.height *
                 (range.end_sample - range.first_sample) * together;
  return tile;
}

}  // namespace

TileSums trace_tile(const Scene& scene, Film film, const TileRange& range, Method method,
                    std::uint32_t batch_groups, const std::stop_token& stop) {
  const FlushDenormals flush;
  return counted(trace_any(scene, film, range, method, batch_groups, stop), range,
                 method.kind != Method::kAdjointPhotons ? 1 : scene.options.group);
}

TileSums trace_from_sensor(const Scene& scene, Film film, const TileRange& range,
                           const std::stop_token& stop) {
  const FlushDenormals flush;
  return counted(trace_side(scene, film, range, Side::kSensor, kBatchGroups, stop), range,
                 scene.options.group);
}

TileSums trace_from_luminaires(const Scene& scene, Film film, const TileRange& range,
                               const std::stop_token& stop) {
  const FlushDenormals flush;
  return counted(trace_side(scene, film, range, Side::kLuminaires, kBatchGroups, stop), range,
                 scene.options.group);
}

}  // namespace nocturne

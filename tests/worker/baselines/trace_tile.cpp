#include "baselines/trace_tile.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "baselines/path_tracer.h"
#include "baselines/ray_marcher.h"
#include "tile/block_samples.h"
#include "tracer/flush_denormals.h"
#include "tracer/pixel_sample.h"
#include "tracer/response.h"

namespace nocturne::baselines {
namespace {

// Trace is PathResult(start, sequence).
template <class Trace>
TileSums trace_each(const Scene& scene, Film film, const TileRange& range, const Trace& trace) {
  const FlushDenormals flush;
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
        const PathResult path = trace(from.start, sequence);
        ++tile.photons;
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

}  // namespace

TileSums trace_tile_by_paths(const Scene& scene, Film film, const TileRange& range) {
  if (!scene.media.empty()) throw std::invalid_argument("the path tracer knows no media");
  return trace_each(scene, film, range, [&](const Start<1>& start, const PhotonSequence& sequence) {
    return trace_path(scene, start, sequence);
  });
}

TileSums trace_tile_by_marching(const Scene& scene, Film film, const TileRange& range,
                                std::uint32_t steps) {
  return trace_each(scene, film, range, [&](const Start<1>& start, const PhotonSequence& sequence) {
    return march_ray(scene, start, sequence, steps);
  });
}

}  // namespace nocturne::baselines

#include "tracer/trace_tile.h"

#include <stdexcept>
#include <vector>

#include "tile/block_samples.h"
#include "tracer/by_kind.h"
#include "tracer/flush_denormals.h"
#include "tracer/pixel_batches.h"
#include "tracer/response.h"
#include "tracer/sharing/sharing_blocks.h"

namespace nocturne {
namespace {

/// f(pixel and sample) for all samples of a tile, in an order in which each pixel's come by number;
/// `begin(samples)` before so many that belong together.
template <class Begin, class F>
void for_each_sample(const TileRange& range, std::uint32_t sharing, const Begin& begin,
                     const F& f) {
  if (sharing == 1) {
    for (std::uint32_t y = range.y; y < range.y + range.height; ++y) {
      for (std::uint32_t x = range.x; x < range.x + range.width; ++x) {
        for (std::uint32_t sample = range.first_sample; sample < range.end_sample; ++sample) {
          begin(1);
          f({x, y, sample});
        }
      }
    }
    return;
  }
  for_each_sharing_block(range, [&](const SharingBlock& block) {
    for (std::uint32_t sample = block.first_sample; sample < block.end_sample; ++sample) {
      begin(block.width * block.height);
      for (std::uint32_t y = block.y; y < block.y + block.height; ++y) {
        for (std::uint32_t x = block.x; x < block.x + block.width; ++x) {
          f({x, y, sample, x == block.x && y == block.y});
        }
      }
    }
  });
}

/// Sums over the samples of a tile. A pixel's are added in their order, whatever the batches.
template <int N, bool Media, bool Polarised = false>
TileSums trace_pixels(const Scene& scene, Film film, const TileRange& range, std::uint32_t groups,
                      const std::stop_token& stop, SkySightings* sightings) {
  TileSums tile(range.width, range.height, scene.wavelengths.further_curves());
  BlockSamples blocks(tile, range.end_sample - range.first_sample);
  const std::uint32_t size = samples_in_batch(scene.options, groups);
  PixelBatches<N, Media, Polarised> batches(scene, film, size, stop);
  if (sightings != nullptr) batches.keep_sightings(*sightings);
  std::vector<PixelIndex> samples;
  std::vector<double> values;
  const auto trace = [&] {
    values.assign(samples.size() * tile.values(), 0.0);
    batches.trace(samples, tile, values.data());
    const double* measured = values.data();
    for (const PixelIndex& at : samples) {
      const std::uint32_t x = at.x - range.x, y = at.y - range.y;
      const std::size_t pixel = y * std::size_t{range.width} + x;
      add_sample(measured, tile.further, &tile.sums[pixel * tile.channels]);
      blocks.add(x, y, at.sample - range.first_sample, measured);
      measured += tile.values();
    }
    samples.clear();
  };
  for_each_sample(
      range, scene.options.sharing,
      [&](std::size_t together) {
        if (samples.size() + together > size) trace();
      },
      [&](const PixelIndex& at) { samples.push_back(at); });
  trace();
  blocks.add_to(tile);
  return tile;
}

}  // namespace

TileSums trace_tile(const Scene& scene, Film film, const TileRange& range,
                    std::uint32_t batch_groups, const std::stop_token& stop,
                    SkySightings* sightings) {
  if (scene.options.direction == Direction::kForward) {
    throw std::invalid_argument("a tile of a scene of forward photons alone");
  }
  const FlushDenormals flush;
  TileSums tile = by_kind_of(scene, [&]<int N, bool Media>() {
    const auto trace = scene.polarised ? &trace_pixels<N, true, true> : &trace_pixels<N, Media>;
    return trace(scene, film, range, batch_groups, stop, sightings);
  });
  tile.photons = static_cast<std::uint64_t>(range.width) * range.height *
                 (range.end_sample - range.first_sample) * scene.options.group;
  return tile;
}

}  // namespace nocturne

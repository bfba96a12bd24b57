// Pixels whose photons share the light they find (docs/decisions/0061): squares of 4 x 4, cut off
// at the tile's edge. The grid is shifted from run to run of samples, so that no pattern of squares
// stays in the image.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "tile/tile_sums.h"

namespace nocturne {

/// Samples for which the grid stands still, from `first` to before `end`. The numbers of a pixel
/// are stratified within them, and so are those of the block as a whole.
struct SharingRun {
  std::uint32_t index, first, end;
};

/// The run of a sample: each is as long as all before it together, so that half of all samples
/// are stratified together, however many there are (docs/decisions/0097).
constexpr SharingRun sharing_run(std::uint32_t sample) {
  constexpr std::uint32_t kFirst = 32;
  const auto index = static_cast<std::uint32_t>(std::bit_width(sample / kFirst));
  if (index == 0) return {0, 0, kFirst};
  const std::uint32_t first = kFirst << (index - 1);
  return {index, first, 2 * first};
}

/// Pixels in a block: along an edge and in all.
inline constexpr std::uint32_t kSharingSide = 4, kSharingPixels = kSharingSide * kSharingSide;

/// Which point of its block's sequence a pixel has for a sample: those of a pixel's run are a net,
/// and those of the block's, too. `place` is the pixel's in its block.
constexpr std::uint32_t number_in_block(std::uint32_t sample, std::uint32_t place) {
  const SharingRun run = sharing_run(sample);
  return run.first * kSharingPixels + place * (run.end - run.first) + sample - run.first;
}

/// How far the grid is shifted in a run of samples, below the side in each direction. All shifts
/// have their turn, and those of four runs are far apart.
struct SharingShift {
  std::uint32_t x, y;
};
constexpr SharingShift sharing_shift(std::uint32_t run) {
  std::uint32_t x = 0, y = 0;
  for (std::uint32_t size = kSharingSide, bits = run; size > 1; size /= 2, bits /= 4) {
    const std::uint32_t low = bits & 1u, high = (bits >> 1) & 1u;
    x += (low ^ high) * (size / 2);
    y += low * (size / 2);
  }
  return {x, y};
}

/// Some samples of the pixels of a block.
using SharingBlock = TileRange;

/// f(block) for each block of a tile in each run of its samples, in the order of the runs.
template <class F>
void for_each_sharing_block(const TileRange& range, const F& f) {
  for (std::uint32_t first = range.first_sample; first < range.end_sample;) {
    const SharingRun run = sharing_run(first);
    const std::uint32_t end = std::min(range.end_sample, run.end);
    const SharingShift shift = sharing_shift(run.index);
    const auto cut = [](std::uint32_t size, std::uint32_t shift_by, const auto& piece) {
      for (std::uint32_t begin = 0, next = shift_by == 0 ? kSharingSide : shift_by; begin < size;
           begin = next, next += kSharingSide) {
        piece(begin, std::min(next, size) - begin);
      }
    };
    cut(range.height, shift.y, [&](std::uint32_t y, std::uint32_t height) {
      cut(range.width, shift.x, [&](std::uint32_t x, std::uint32_t width) {
        f(SharingBlock{range.x + x, range.y + y, width, height, first, end});
      });
    });
    first = end;
  }
}

}  // namespace nocturne

// Pixels whose photons share what they find (docs/decisions/0061): squares of 2 x 2 or 4 x 4, cut
// off at the tile's edge. The grid is shifted from run to run of a few samples, so that no pattern
// of squares stays in the image.
#pragma once

#include <algorithm>
#include <cstdint>

#include "tile/tile_sums.h"

namespace nocturne {

/// Samples for which the grid stands still. The numbers of a pixel are stratified within them, and
/// so are those of the block as a whole.
inline constexpr std::uint32_t kSharingRun = 16;

/// In a block.
inline constexpr std::uint32_t kMaxSharing = 16;

/// How far the grid is shifted in a run of samples, each way below `side`, a power of 2. All shifts
/// have their turn, and those of four runs are far apart.
struct SharingShift {
  std::uint32_t x, y;
};
constexpr SharingShift sharing_shift(std::uint32_t run, std::uint32_t side) {
  std::uint32_t x = 0, y = 0;
  for (std::uint32_t size = side, bits = run; size > 1; size /= 2, bits /= 4) {
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
void for_each_sharing_block(const TileRange& range, std::uint32_t side, const F& f) {
  for (std::uint32_t first = range.first_sample; first < range.end_sample;) {
    const std::uint32_t run = first / kSharingRun;
    const std::uint32_t end = std::min(range.end_sample, (run + 1) * kSharingRun);
    const SharingShift shift = sharing_shift(run, side);
    const auto cut = [side](std::uint32_t size, std::uint32_t shift_by, const auto& piece) {
      for (std::uint32_t begin = 0, next = shift_by == 0 ? side : shift_by; begin < size;
           begin = next, next += side) {
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

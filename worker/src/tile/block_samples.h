// What blocks of pixels measure in each sample: their squares tell the errors of regions, also
// where neighbours share what they found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tile/tile_sums.h"

namespace nocturne {

class BlockSamples {
 public:
  /// Of the blocks of a tile in `samples` samples.
  BlockSamples(const TileSums& tile, std::uint32_t samples)
      : columns_(tile.block_columns()),
        samples_(samples),
        values_(tile.block_squares.size() * samples) {}

  /// Y of a pixel, counted from the tile's corner, in a sample, counted from the first one. A
  /// block's pixels must come in one order, whatever the batches are.
  void add(std::uint32_t x, std::uint32_t y, std::uint32_t sample, double value) {
    const std::size_t block = std::size_t{y / TileSums::kBlock} * columns_ + x / TileSums::kBlock;
    values_[block * samples_ + sample] += value;
  }

  /// Adds the squares to a tile's.
  void add_to(TileSums& tile) const {
    std::vector<double> whole(samples_);
    const double* value = values_.data();
    for (double& of_block : tile.block_squares) {
      double squares = 0.0;
      for (double& total : whole) {
        squares += *value * *value;
        total += *value++;
      }
      of_block += squares;
    }
    for (const double total : whole) tile.tile_squares.front() += total * total;
  }

 private:
  const std::size_t columns_, samples_;
  std::vector<double> values_;
};

}  // namespace nocturne

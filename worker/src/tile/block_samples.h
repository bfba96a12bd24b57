// The joint values of blocks of pixels in each sample: their products give the errors of regions,
// also where neighbours share the paths that they found.
#pragma once

#include <algorithm>
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
        further_(tile.further),
        values_(tile.block_products.size() / TileSums::kProducts * samples * kValues),
        of_tile_(tile.values() * samples) {}

  /// X, Y, Z and further responses of a pixel, counted from the tile's corner, in a sample, counted
  /// from the first one. Pixels must come in one order, whatever the batches are.
  void add(std::uint32_t x, std::uint32_t y, std::uint32_t sample, const double* measured) {
    const std::size_t block = std::size_t{y / TileSums::kBlock} * columns_ + x / TileSums::kBlock;
    double* const value = &values_[(block * samples_ + sample) * kValues];
    for (std::size_t i = 0; i < kValues; ++i) value[i] += measured[i];
    double* const further = &of_tile_[sample * (kValues + further_)] + kValues;
    for (std::size_t i = 0; i < further_; ++i) further[i] += measured[kValues + i];
  }

  /// Adds the products to a tile's.
  void add_to(TileSums& tile) const {
    std::vector<double> whole(samples_ * kValues);
    const double* value = values_.data();
    for (std::size_t at = 0; at < tile.block_products.size(); at += TileSums::kProducts) {
      add_products(value, &tile.block_products[at]);
      for (double& total : whole) total += *value++;
    }
    add_products(whole.data(), tile.tile_products.data());
    if (further_ == 0) return;
    std::vector<double> values(kValues + further_);
    for (std::size_t sample = 0; sample < samples_; ++sample) {
      std::copy_n(&whole[sample * kValues], kValues, values.begin());
      std::copy_n(&of_tile_[sample * values.size()] + kValues, further_, values.begin() + kValues);
      add_further_products(values.data(), further_, &tile.tile_products[TileSums::kProducts]);
    }
  }

 private:
  static constexpr std::size_t kValues = TileSums::kXyzValues;

  void add_products(const double* values, double* to) const {
    std::array<double, TileSums::kProducts> sums{};
    for (std::size_t sample = 0; sample < samples_; ++sample, values += kValues) {
      const auto products = products_of(values);
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += products[i];
    }
    for (std::size_t i = 0; i < sums.size(); ++i) to[i] += sums[i];
  }

  const std::size_t columns_, samples_, further_;
  std::vector<double> values_;
  /// Further responses of the whole tile, sample by sample, behind room for X, Y, Z.
  std::vector<double> of_tile_;
};

}  // namespace nocturne

// A unit of work, and its result: sums and counts, never averages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nocturne {

/// Samples [first_sample, end_sample) of a rectangle of pixels; x to the right, y down.
struct TileRange {
  std::uint32_t x, y, width, height;
  std::uint32_t first_sample, end_sample;
};

/// Float64: single precision stops counting at 2^24 samples.
struct TileSums {
  /// What a sample measures before further responses: X, Y, Z.
  static constexpr std::size_t kXyzValues = 3;
  /// A pixel's sums before those of further responses: X, Y, Z, YY, XX, ZZ, XY, XZ, YZ.
  static constexpr std::size_t kXyzSums = 9;
  /// Products of the joint sums of pixels: YY, XX, ZZ, XY, XZ, YZ.
  static constexpr std::size_t kProducts = 6;
  /// Edge of a block, pixels. Blocks begin at the tile's upper left corner.
  static constexpr std::uint32_t kBlock = 4;

  std::uint32_t width, height;
  /// Further responses of the sensor.
  std::size_t further;
  /// kXyzSums; then a sum for each further response, and one of its square for each.
  std::size_t channels;
  /// Channels of each pixel side by side, row by row.
  std::vector<double> sums;
  /// Over samples, the kProducts of what each block's pixels together have, row by row: from them
  /// come errors of regions, also where pixels are not independent.
  std::vector<double> block_products;
  /// The same of the whole tile; of a film's tiles, row by row. With further responses there
  /// follow, for each of them, its products with X, Y, Z, with those before it and with itself:
  /// from them come errors of what is made of many responses, such as colour rendering.
  std::vector<double> tile_products;
  std::uint64_t photons = 0;
  std::uint64_t rays = 0;
  /// Photons left out because their contribution was negative or not finite.
  std::uint64_t invalid_samples = 0;
  /// Photons ended by a limit of the tracer that is no property of the scene: bias.
  std::uint64_t truncated_paths = 0;

  TileSums(std::uint32_t w, std::uint32_t h, std::size_t further_responses, std::size_t tiles = 1)
      : width(w),
        height(h),
        further(further_responses),
        channels(kXyzSums + 2 * further),
        sums(channels * w * h),
        block_products(kProducts * block_columns() * blocks_in(h)),
        tile_products(products_of_tile() * tiles) {}

  /// Numbers in `tile_products` for each tile.
  std::size_t products_of_tile() const { return kProducts + further * (further + 7) / 2; }
  static std::uint32_t blocks_in(std::uint32_t pixels) { return (pixels + kBlock - 1) / kBlock; }
  std::uint32_t block_columns() const { return blocks_in(width); }
  /// Of a sample: X, Y, Z, further responses.
  std::size_t values() const { return kXyzValues + further; }

  /// All numbers, in the order in which they are sent and written: pixels, blocks, tiles.
  std::array<const std::vector<double>*, 3> numbers() const {
    return {&sums, &block_products, &tile_products};
  }

  /// Sums of other samples of the same pixels.
  TileSums& operator+=(const TileSums& other) {
    add(other.sums, sums);
    add(other.block_products, block_products);
    add(other.tile_products, tile_products);
    return add_counts(other);
  }

  TileSums& add_counts(const TileSums& other) {
    photons += other.photons;
    rays += other.rays;
    invalid_samples += other.invalid_samples;
    truncated_paths += other.truncated_paths;
    return *this;
  }

 private:
  static void add(const std::vector<double>& from, std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
  }
};

/// Of one X, Y, Z, in the order that TileSums has.
inline std::array<double, TileSums::kProducts> products_of(const double* xyz) {
  const double x = xyz[0], y = xyz[1], z = xyz[2];
  return {y * y, x * x, z * z, x * y, x * z, y * z};
}

/// Adds products of further responses to those of a tile, in the order that TileSums has; `values`:
/// X, Y, Z, further responses.
inline void add_further_products(const double* values, std::size_t further, double* products) {
  for (std::size_t a = TileSums::kXyzValues; a < TileSums::kXyzValues + further; ++a) {
    // Most photons bring light to one or two bands.
    if (values[a] != 0.0) {
      for (std::size_t b = 0; b <= a; ++b) products[b] += values[a] * values[b];
    }
    products += a + 1;
  }
}

/// One sample's values into a pixel's sums, in the order that TileSums has.
inline void add_sample(const double* sample, std::size_t further, double* pixel) {
  const auto products = products_of(sample);
  for (std::size_t c = 0; c < TileSums::kXyzValues; ++c) pixel[c] += sample[c];
  for (std::size_t c = 0; c < TileSums::kProducts; ++c) {
    pixel[TileSums::kXyzValues + c] += products[c];
  }
  const double* const responses = sample + TileSums::kXyzValues;
  double* const sums = pixel + TileSums::kXyzSums;
  for (std::size_t c = 0; c < further; ++c) {
    sums[c] += responses[c];
    sums[further + c] += responses[c] * responses[c];
  }
}

}  // namespace nocturne

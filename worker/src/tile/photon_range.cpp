#include "tile/photon_range.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <stdexcept>

namespace nocturne {
namespace {

constexpr std::size_t kProducts = TileSums::kProducts;

/// Of a float32, how many bytes are kept.
enum Kept : std::uint8_t { kAll = 4, kUpperHalf = 2 };

Kept kept_of(std::size_t channel, const TileSums& sums) {
  const bool value = channel < TileSums::kXyzValues ||
                     (channel >= TileSums::kXyzSums && channel < TileSums::kXyzSums + sums.further);
  return value ? kAll : kUpperHalf;
}

std::uint32_t bits_of(double value, Kept kept) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  // Halves go up, which gives one result on all machines.
  return kept == kAll ? bits : (bits + 0x8000u) & 0xFFFF0000u;
}

/// f(numbers, how many lie between two of a kind, the part of them that is kept) for each kind.
template <class Sums, class F>
void for_each_kind(Sums& sums, const F& f) {
  for (std::size_t c = 0; c < sums.channels; ++c) {
    f(std::span(sums.sums).subspan(c), sums.channels, kept_of(c, sums));
  }
  const auto of_products = [&](auto& products, std::size_t kinds) {
    for (std::size_t c = 0; c < kinds; ++c) f(std::span(products).subspan(c), kinds, kUpperHalf);
  };
  of_products(sums.block_products, kProducts);
  of_products(sums.tile_products, sums.products_of_tile());
}

std::string compressed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string found(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(found.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_SPEED) != Z_OK) {
    throw std::runtime_error("sums can't be compressed");
  }
  found.resize(size);
  return found;
}

constexpr std::size_t kXyz = TileSums::kXyzValues;

/// What adds up independent numbers; n samples of the film, and N photons whose sums count `scale`
/// times.
struct Independent {
  double samples, photons, scale;

  double sum(double film, double photon_sum) const { return film + scale * photon_sum; }

  /// Sum of products over samples, from those of both and from the sums of the factors, such that
  /// variances of means, or covariances, add up.
  double product(double film, double film_a, double film_b, double photon, double photon_a,
                 double photon_b) const {
    const double whole = sum(film_a, photon_a) * sum(film_b, photon_b) / samples;
    const double of_film = film - film_a * film_b / samples;
    const double of_photons = photon - photon_a * photon_b / photons;
    return whole + of_film + (samples - 1.0) / samples * (scale * scale) * of_photons;
  }

  /// Products of further responses with what comes before them and with themselves, in place.
  void further_products(const double* film_values, const double* photon_values, std::size_t values,
                        const double* photon, double* film) const {
    for (std::size_t a = TileSums::kXyzValues; a < values; ++a) {
      for (std::size_t b = 0; b <= a; ++b, ++photon, ++film) {
        *film = product(*film, film_values[a], film_values[b], *photon, photon_values[a],
                        photon_values[b]);
      }
    }
  }

  /// Six products of X, Y, Z, in place.
  void products(const double* film_xyz, const double* photon_xyz, const double* photon,
                double* film) const {
    static constexpr std::size_t kFactors[kProducts][2] = {{1, 1}, {0, 0}, {2, 2},
                                                           {0, 1}, {0, 2}, {1, 2}};
    for (std::size_t i = 0; i < kProducts; ++i) {
      const auto [a, b] = kFactors[i];
      film[i] = product(film[i], film_xyz[a], film_xyz[b], photon[i], photon_xyz[a], photon_xyz[b]);
    }
  }
};

/// Sums of X, Y, Z and of further responses over the pixels of blocks, row by row.
std::vector<double> block_values(const TileSums& film) {
  std::vector<double> blocks(film.block_products.size() / kProducts * film.values());
  for (std::uint32_t y = 0; y < film.height; ++y) {
    for (std::uint32_t x = 0; x < film.width; ++x) {
      double* const block =
          &blocks[film.values() * (std::size_t{y / TileSums::kBlock} * film.block_columns() +
                                   x / TileSums::kBlock)];
      const double* pixel = &film.sums[film.channels * (std::size_t{y} * film.width + x)];
      for (std::size_t c = 0; c < kXyz; ++c) block[c] += pixel[c];
      for (std::size_t c = 0; c < film.further; ++c) {
        block[kXyz + c] += pixel[TileSums::kXyzSums + c];
      }
    }
  }
  return blocks;
}

/// Sums of blocks over tiles.
std::vector<double> tile_values(const TileSums& film, const std::vector<double>& blocks,
                                std::uint32_t tile_size) {
  const std::uint32_t edge = tile_size / TileSums::kBlock, columns = film.block_columns();
  const std::uint32_t tile_columns = (columns + edge - 1) / edge;
  const std::size_t values = film.values();
  std::vector<double> tiles(film.tile_products.size() / film.products_of_tile() * values);
  for (std::size_t i = 0; i < blocks.size() / values; ++i) {
    double* const tile = &tiles[values * (i / columns / edge * tile_columns + i % columns / edge)];
    for (std::size_t c = 0; c < values; ++c) tile[c] += blocks[i * values + c];
  }
  return tiles;
}

void add_pixel(const Independent& both, const double* photons, std::size_t further, double* film) {
  both.products(film, photons, photons + kXyz, film + kXyz);
  double* const values = film + TileSums::kXyzSums;
  const double* const photon_values = photons + TileSums::kXyzSums;
  for (std::size_t c = 0; c < further; ++c) {
    values[further + c] =
        both.product(values[further + c], values[c], values[c], photon_values[further + c],
                     photon_values[c], photon_values[c]);
    values[c] = both.sum(values[c], photon_values[c]);
  }
  for (std::size_t c = 0; c < kXyz; ++c) film[c] = both.sum(film[c], photons[c]);
}

}  // namespace

void round_photon_sums(TileSums& sums) {
  for_each_kind(sums, [](std::span<double> numbers, std::size_t step, Kept kept) {
    for (std::size_t i = 0; i < numbers.size(); i += step) {
      numbers[i] = static_cast<double>(std::bit_cast<float>(bits_of(numbers[i], kept)));
    }
  });
}

std::string encode_photon_sums(const TileSums& sums) {
  std::string bytes;
  for_each_kind(sums, [&](std::span<const double> numbers, std::size_t step, Kept kept) {
    for (unsigned byte = 0; byte < kept; ++byte) {
      for (std::size_t i = 0; i < numbers.size(); i += step) {
        bytes.push_back(static_cast<char>(bits_of(numbers[i], kept) >> (24u - 8u * byte)));
      }
    }
  });
  return compressed(bytes);
}

void add_photons(const TileSums& photons, std::uint32_t bundles, std::uint32_t samples,
                 std::uint32_t tile_size, TileSums& film) {
  const auto count = static_cast<double>(bundles * kPhotonBundle);
  const double pixels = static_cast<double>(film.width) * film.height;
  const Independent both{static_cast<double>(samples), count, samples * pixels / count};
  const auto film_blocks = block_values(film), photon_blocks = block_values(photons);
  const auto film_tiles = tile_values(film, film_blocks, tile_size);
  const auto photon_tiles = tile_values(film, photon_blocks, tile_size);
  const std::size_t values = film.values(), of_tile = film.products_of_tile();
  for (std::size_t i = 0; i < film_blocks.size() / values; ++i) {
    both.products(&film_blocks[i * values], &photon_blocks[i * values],
                  &photons.block_products[i * kProducts], &film.block_products[i * kProducts]);
  }
  for (std::size_t i = 0; i < film_tiles.size() / values; ++i) {
    const double *const ours = &film_tiles[i * values], *const theirs = &photon_tiles[i * values];
    both.products(ours, theirs, &photons.tile_products[i * of_tile],
                  &film.tile_products[i * of_tile]);
    if (film.further > 0) {
      both.further_products(ours, theirs, values, &photons.tile_products[i * of_tile + kProducts],
                            &film.tile_products[i * of_tile + kProducts]);
    }
  }
  for (std::size_t i = 0; i < film.sums.size(); i += film.channels) {
    add_pixel(both, &photons.sums[i], film.further, &film.sums[i]);
  }
  film.add_counts(photons);
}

}  // namespace nocturne

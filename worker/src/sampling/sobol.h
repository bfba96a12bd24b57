// The first twelve dimensions of the Sobol sequence, four at once: one table row per byte of the
// index holds the xor of its direction numbers for four dimensions side by side, so a point costs
// four loads. Index and point are in reversed bits, as Owen scrambling takes and gives them
// (sampling/owen.h). Direction numbers: Joe and Kuo, "Constructing Sobol sequences with better
// two-dimensional projections", SIAM J. Sci. Comput. 30, 2008 (new-joe-kuo-6, dimensions 1-12).
#pragma once

#include <immintrin.h>

#include <array>
#include <bit>
#include <cstdint>

#include "sampling/owen.h"

namespace nocturne {

struct alignas(16) FourWords {
  std::array<std::uint32_t, 4> lane;
};

inline constexpr std::size_t kSobolTableCount = 3, kSobolDimensions = 4 * kSobolTableCount;

using SobolDirections = std::array<std::array<std::uint32_t, 32>, kSobolDimensions>;

constexpr SobolDirections sobol_direction_numbers() {
  struct Polynomial {
    int degree;
    std::uint32_t coefficients;
    std::array<std::uint32_t, 5> initial;
  };
  constexpr std::array<Polynomial, kSobolDimensions - 1> kPolynomials{{{1, 0, {1}},
                                                                       {2, 1, {1, 3}},
                                                                       {3, 1, {1, 3, 1}},
                                                                       {3, 2, {1, 1, 1}},
                                                                       {4, 1, {1, 1, 3, 3}},
                                                                       {4, 4, {1, 3, 5, 13}},
                                                                       {5, 2, {1, 1, 5, 5, 17}},
                                                                       {5, 4, {1, 1, 5, 5, 5}},
                                                                       {5, 7, {1, 1, 7, 11, 19}},
                                                                       {5, 11, {1, 1, 5, 1, 1}},
                                                                       {5, 13, {1, 1, 1, 3, 11}}}};
  SobolDirections v{};
  for (int bit = 0; bit < 32; ++bit) v[0][static_cast<std::size_t>(bit)] = 1u << (31 - bit);
  for (std::size_t d = 0; d < kPolynomials.size(); ++d) {
    const auto& p = kPolynomials[d];
    auto& w = v[d + 1];
    for (int bit = 0; bit < 32; ++bit) {
      const auto i = static_cast<std::size_t>(bit);
      if (bit < p.degree) {
        w[i] = p.initial[i] << (31 - bit);
        continue;
      }
      const auto s = static_cast<std::size_t>(p.degree);
      w[i] = w[i - s] ^ (w[i - s] >> p.degree);
      for (int k = 1; k < p.degree; ++k) {
        if ((p.coefficients >> (p.degree - 1 - k)) & 1u) w[i] ^= w[i - static_cast<std::size_t>(k)];
      }
    }
  }
  return v;
}

/// By byte of the index and its value.
using SobolTable = std::array<std::array<FourWords, 256>, 4>;

constexpr std::array<SobolTable, kSobolTableCount> sobol_tables() {
  const auto v = sobol_direction_numbers();
  std::array<SobolTable, kSobolTableCount> tables{};
  for (std::size_t d = 0; d < kSobolDimensions; ++d) {
    for (std::size_t byte = 0; byte < 4; ++byte) {
      auto& rows = tables[d / 4][byte];
      for (std::size_t value = 1; value < 256; ++value) {  // one bit more than an earlier one
        const auto low = static_cast<std::size_t>(std::countr_zero(value));
        rows[value].lane[d % 4] =
            rows[value & (value - 1)].lane[d % 4] ^ reverse_bits(v[d][31 - (8 * byte + low)]);
      }
    }
  }
  return tables;
}

inline constexpr auto kSobolTables = sobol_tables();

/// Four dimensions of a point, from 4 * `table` on, as reversed 32-bit fractions, by its reversed
/// index.
inline __m128i sobol4(std::uint32_t table, std::uint32_t reversed_index) {
  const SobolTable& rows = kSobolTables[table];
  const auto row = [&](std::size_t byte, std::uint32_t value) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(&rows[byte][value & 0xFFu]));
  };
  const std::uint32_t i = reversed_index;
  return _mm_xor_si128(_mm_xor_si128(row(0, i), row(1, i >> 8)),
                       _mm_xor_si128(row(2, i >> 16), row(3, i >> 24)));
}

}  // namespace nocturne

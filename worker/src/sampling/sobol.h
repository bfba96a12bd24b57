// The first four dimensions of the Sobol sequence, all at once: one table row per byte of the index
// holds the xor of its direction numbers for the four dimensions side by side, so a point costs
// four loads. Index and point are in reversed bits, as Owen scrambling takes and gives them
// (sampling/owen.h). Direction numbers: Joe and Kuo, "Constructing Sobol sequences with better
// two-dimensional projections", SIAM J. Sci. Comput. 30, 2008 (new-joe-kuo-6, dimensions 1-4).
#pragma once

#include <immintrin.h>

#include <array>
#include <cstdint>

#include "sampling/owen.h"

namespace nocturne {

struct alignas(16) FourWords {
  std::array<std::uint32_t, 4> lane;
};

constexpr std::array<std::array<std::uint32_t, 32>, 4> sobol_direction_numbers() {
  struct Polynomial {
    int degree;
    std::uint32_t coefficients;
    std::array<std::uint32_t, 3> initial;
  };
  constexpr std::array<Polynomial, 3> kPolynomials{
      {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};
  std::array<std::array<std::uint32_t, 32>, 4> v{};
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

constexpr std::array<std::array<FourWords, 256>, 4> sobol_byte_tables() {
  const auto v = sobol_direction_numbers();
  std::array<std::array<FourWords, 256>, 4> tables{};
  for (std::size_t byte = 0; byte < 4; ++byte) {
    for (std::size_t value = 0; value < 256; ++value) {
      for (std::size_t d = 0; d < 4; ++d) {
        std::uint32_t x = 0;
        for (std::size_t bit = 0; bit < 8; ++bit) {
          if ((value >> bit) & 1u) x ^= v[d][31 - (8 * byte + bit)];
        }
        tables[byte][value].lane[d] = reverse_bits(x);
      }
    }
  }
  return tables;
}

inline constexpr auto kSobolTables = sobol_byte_tables();

/// Dimensions 0-3 of a point, as reversed 32-bit fractions, by its reversed index.
inline __m128i sobol4(std::uint32_t reversed_index) {
  const auto row = [](std::size_t byte, std::uint32_t value) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(&kSobolTables[byte][value & 0xFFu]));
  };
  const std::uint32_t i = reversed_index;
  return _mm_xor_si128(_mm_xor_si128(row(0, i), row(1, i >> 8)),
                       _mm_xor_si128(row(2, i >> 16), row(3, i >> 24)));
}

}  // namespace nocturne

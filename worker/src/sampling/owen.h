// Owen's nested uniform scrambling by hashing: bit reversal around a hash in which every bit
// depends on lower bits only. Numbers that are kept reversed need it only at the end. Laine and
// Karras, "Stratified sampling for stochastic transparency", EGSR 2011; Burley, "Practical
// hash-based Owen scrambling", JCGT 9(4), 2020; constants of N. Vegdahl's improved hash (2021),
// chosen for lower bias.
#pragma once

#include <immintrin.h>

#include <cstdint>

namespace nocturne {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0x0F0F0F0Fu) << 4) | ((x >> 4) & 0x0F0F0F0Fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Of eight words.
inline __m256i reverse_bits(__m256i x) {
  const __m128i swap = _mm_set_epi8(12, 13, 14, 15, 8, 9, 10, 11, 4, 5, 6, 7, 0, 1, 2, 3);
  const __m128i low_nibbles = _mm_setr_epi8(
      0x00, static_cast<char>(0x80), 0x40, static_cast<char>(0xC0), 0x20, static_cast<char>(0xA0),
      0x60, static_cast<char>(0xE0), 0x10, static_cast<char>(0x90), 0x50, static_cast<char>(0xD0),
      0x30, static_cast<char>(0xB0), 0x70, static_cast<char>(0xF0));
  const __m256i table = _mm256_broadcastsi128_si256(low_nibbles);
  const __m256i mask = _mm256_set1_epi8(0x0F);
  x = _mm256_shuffle_epi8(x, _mm256_broadcastsi128_si256(swap));
  const __m256i high = _mm256_shuffle_epi8(table, _mm256_and_si256(x, mask));
  const __m256i low = _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi32(x, 4), mask));
  return _mm256_or_si256(high, _mm256_and_si256(_mm256_srli_epi32(low, 4), mask));
}

/// Of a reversed 32-bit fraction; or of a reversed sample index, which it shuffles so that every
/// aligned power-of-two block stays together.
inline std::uint32_t nested_hash(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3D20ADEAu;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526C56u;
  x ^= x * 0x53A22864u;
  return x;
}

/// Of eight, each with its seed.
inline __m256i nested_hash(__m256i x, __m256i seed) {
  const auto xor_multiple = [](__m256i v, std::uint32_t constant) {
    return _mm256_xor_si256(v,
                            _mm256_mullo_epi32(v, _mm256_set1_epi32(static_cast<int>(constant))));
  };
  x = xor_multiple(x, 0x3D20ADEAu);
  x = _mm256_add_epi32(x, seed);
  x = _mm256_mullo_epi32(x, _mm256_or_si256(_mm256_srli_epi32(seed, 16), _mm256_set1_epi32(1)));
  x = xor_multiple(x, 0x05526C56u);
  return xor_multiple(x, 0x53A22864u);
}

}  // namespace nocturne

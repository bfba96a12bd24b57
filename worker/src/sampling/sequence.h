// The random numbers of one photon, a pure function of (seed, pixel, sample, dimension): any sample
// range can be computed anywhere. Numbers come in sets of four dimensions. Sobol: each set is the
// four-dimensional Sobol sequence with its own index shuffle and Owen scramble (padding, Burley
// 2020), each pixel its own randomisation.
#pragma once

#include <array>
#include <cstdint>

#include "sampling/owen.h"
#include "sampling/philox.h"
#include "sampling/sobol.h"

namespace nocturne {

enum class SequenceKind { kSobol, kIndependent };

/// Four uniform numbers in [0, 1).
using Uniform4 = std::array<float, 4>;

/// A 32-bit fraction as a float in [0, 1): numbers near 0 keep their small steps, those near 1
/// never round to 1.
inline float to_unit(std::uint32_t bits) {
  constexpr float kLargestBelowOne = 0x1.fffffep-1f;
  const float u = static_cast<float>(bits) * 0x1p-32f;
  return u < kLargestBelowOne ? u : kLargestBelowOne;
}

class PhotonSequence {
 public:
  PhotonSequence(SequenceKind kind, std::uint64_t seed, std::uint32_t pixel, std::uint32_t sample)
      : kind_(kind),
        key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        pixel_(pixel),
        sample_(sample),
        pixel_hash_(mix(mix(seed) + pixel)) {}

  /// The next four dimensions.
  Uniform4 next() {
    const std::uint32_t set = set_++;
    if (kind_ == SequenceKind::kSobol) return sobol(set);
    const auto words = philox4x32({sample_, set, pixel_, 0u}, key_);
    return {to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])};
  }

 private:
  /// SplitMix64's finaliser (Steele, Lea and Flood, OOPSLA 2014).
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
  }

  Uniform4 sobol(std::uint32_t set) const {
    const std::uint64_t a = mix(pixel_hash_ + 3u * set);
    const std::uint64_t b = mix(pixel_hash_ + 3u * set + 1u);
    const std::uint64_t shuffle = mix(pixel_hash_ + 3u * set + 2u);
    const __m128i seeds = _mm_set_epi64x(static_cast<long long>(b), static_cast<long long>(a));
    const std::uint32_t index = owen_scramble(sample_, static_cast<std::uint32_t>(shuffle));
    FourWords words;
    _mm_store_si128(reinterpret_cast<__m128i*>(&words), owen_scramble(sobol4(index), seeds));
    return {to_unit(words.lane[0]), to_unit(words.lane[1]), to_unit(words.lane[2]),
            to_unit(words.lane[3])};
  }

  SequenceKind kind_;
  std::array<std::uint32_t, 2> key_;
  std::uint32_t pixel_, sample_, set_ = 0;
  std::uint64_t pixel_hash_;
};

}  // namespace nocturne

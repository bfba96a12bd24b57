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

/// What the photons of one pixel share. Not safe between threads: it remembers the scrambles of its
/// first sets.
class PixelSequence {
 public:
  /// How the numbers of one set are randomised: a shuffle of the sample index, and a scramble for
  /// each dimension.
  struct Randomisation {
    __m128i scrambles;
    std::uint32_t shuffle;
  };

  PixelSequence(SequenceKind kind, std::uint64_t seed, std::uint32_t pixel)
      : kind_(kind),
        key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        pixel_(pixel),
        hash_(mix(mix(seed) + pixel)) {}

  SequenceKind kind() const { return kind_; }

  /// Independent numbers of any sample and set.
  std::array<std::uint32_t, 4> independent(std::uint32_t sample, std::uint32_t set) const {
    return philox4x32({sample, set, pixel_, 0u}, key_);
  }

  /// Sets are asked for in order by every photon, so the first ones are worth keeping.
  Randomisation randomisation(std::uint32_t set) {
    if (set >= kRemembered) return make(set);
    while (known_ <= set) {
      remembered_[known_] = make(known_);
      ++known_;
    }
    return remembered_[set];
  }

 private:
  // Two cache lines' worth; photons with more vertices are few.
  static constexpr std::uint32_t kRemembered = 8;

  /// SplitMix64's finaliser (Steele, Lea and Flood, OOPSLA 2014).
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
  }

  Randomisation make(std::uint32_t set) const {
    const std::uint64_t first = hash_ + 3u * static_cast<std::uint64_t>(set);
    return {
        _mm_set_epi64x(static_cast<long long>(mix(first + 1u)), static_cast<long long>(mix(first))),
        static_cast<std::uint32_t>(mix(first + 2u))};
  }

  SequenceKind kind_;
  std::array<std::uint32_t, 2> key_;
  std::uint32_t pixel_;
  std::uint32_t known_ = 0;
  std::uint64_t hash_;
  std::array<Randomisation, kRemembered> remembered_;
};

class PhotonSequence {
 public:
  PhotonSequence(PixelSequence& pixel, std::uint32_t sample) : pixel_(&pixel), sample_(sample) {}

  /// The next four dimensions.
  Uniform4 next() {
    const std::uint32_t set = set_++;
    FourWords words;
    if (pixel_->kind() == SequenceKind::kSobol) {
      const auto randomisation = pixel_->randomisation(set);
      const std::uint32_t index = owen_scramble(sample_, randomisation.shuffle);
      _mm_store_si128(reinterpret_cast<__m128i*>(&words),
                      owen_scramble(sobol4(index), randomisation.scrambles));
    } else {
      words.lane = pixel_->independent(sample_, set);
    }
    return {to_unit(words.lane[0]), to_unit(words.lane[1]), to_unit(words.lane[2]),
            to_unit(words.lane[3])};
  }

  /// Numbers of a photon that leaves this one's way: they have nothing in common with what follows
  /// here. Number 1 or 2.
  PhotonSequence branch(std::uint32_t number) const {
    PhotonSequence other = *this;
    other.set_ += number << 24;
    return other;
  }

 private:
  PixelSequence* pixel_;
  std::uint32_t sample_, set_ = 0;
};

}  // namespace nocturne

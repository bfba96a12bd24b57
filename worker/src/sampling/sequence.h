// The random numbers of one photon, a pure function of (seed, pixel, sample, dimension): any sample
// range can be computed anywhere. Numbers come in sets of four dimensions. Sobol: each set is the
// four-dimensional Sobol sequence with its own index shuffle and Owen scramble (padding, Burley
// 2020), but for a few that are joint: further dimensions of one sequence. Each pixel has its own
// randomisation.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "math/constants.h"
#include "math/splitmix64.h"
#include "sampling/owen.h"
#include "sampling/philox.h"
#include "sampling/sobol.h"

namespace nocturne {

enum class SequenceKind { kSobol, kIndependent };

/// Four uniform numbers in [0, 1).
using Uniform4 = std::array<float, 4>;

/// A 32-bit fraction as a float in [0, 1): numbers near 0 keep their small steps, those near 1
/// never round to 1.
inline float to_unit(std::uint32_t fraction) {
  return std::min(static_cast<float>(fraction) * 0x1p-32f, kOneMinusEpsilon);
}

/// Eight at once.
inline __m256 to_unit(__m256i fractions) {
  // AVX2 converts signed words only. Both halves are exact, so that the sum is rounded once.
  const __m256 high = _mm256_cvtepi32_ps(_mm256_srli_epi32(fractions, 16));
  const __m256 low = _mm256_cvtepi32_ps(_mm256_and_si256(fractions, _mm256_set1_epi32(0xFFFF)));
  const __m256 whole = _mm256_add_ps(_mm256_mul_ps(high, _mm256_set1_ps(0x1p16f)), low);
  return _mm256_min_ps(_mm256_mul_ps(whole, _mm256_set1_ps(0x1p-32f)),
                       _mm256_set1_ps(kOneMinusEpsilon));
}

/// Four.
inline Uniform4 to_unit(__m128i fractions) {
  Uniform4 u;
  _mm_storeu_ps(u.data(), _mm256_castps256_ps128(to_unit(_mm256_castsi128_si256(fractions))));
  return u;
}

/// Sets that are dimensions of one sequence, in this order, at most kSobolTableCount.
struct JointSets {
  std::array<std::uint32_t, kSobolTableCount> sets{};
  std::uint32_t count = 0;
  /// The index is shuffled alike for all pixels: one may have a dimension of another and is spread
  /// evenly with it.
  bool alike = false;
};

/// What the photons of one pixel share. Not safe between threads: it remembers the scrambles of its
/// first sets.
class PixelSequence {
 public:
  /// How the numbers of one set are randomised: a shuffle of the sample index, and a scramble for
  /// each dimension, and the dimensions of the Sobol sequence that they are.
  struct Randomisation {
    __m128i scrambles;
    std::uint32_t shuffle, table;
  };

  PixelSequence(SequenceKind kind, std::uint64_t seed, std::uint32_t pixel,
                const JointSets& joint = {})
      : kind_(kind),
        key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        pixel_(pixel),
        hash_(splitmix64(splitmix64(seed) + pixel)),
        joint_(joint),
        joint_shuffle_(joint.alike ? static_cast<std::uint32_t>(splitmix64(~seed))
                                   : static_cast<std::uint32_t>(word(joint.sets[0], 2))) {}

  SequenceKind kind() const { return kind_; }

  /// Independent numbers of any sample and set.
  __m128i independent(std::uint32_t sample, std::uint32_t set) const {
    return std::bit_cast<__m128i>(philox4x32({sample, set, pixel_, 0u}, key_));
  }

  /// Every photon asks for the same first sets of its path and of its branches, so these are kept.
  Randomisation randomisation(std::uint32_t set) {
    const std::uint32_t branch = set >> kBranchBits, own = set & ((1u << kBranchBits) - 1u);
    if (own >= kRemembered || branch >= kBranches) return make(set);
    const std::uint32_t slot = branch * kRemembered + own;
    if (((known_ >> slot) & 1u) == 0) {
      remembered_[slot] = make(set);
      known_ |= 1u << slot;
    }
    return remembered_[slot];
  }

  /// The sets of branch k of a photon are those from k << kBranchBits on.
  static constexpr std::uint32_t kBranchBits = 24;
  static constexpr std::uint32_t set_of_branch(std::uint32_t branch, std::uint32_t set) {
    return (branch << kBranchBits) + set;
  }

 private:
  // Photons with more vertices are few, and so are those that branch twice.
  static constexpr std::uint32_t kRemembered = 8, kBranches = 2;

  /// The scrambles' words and the shuffle's are three in a row.
  std::uint64_t word(std::uint32_t set, std::uint32_t index) const {
    return splitmix64(hash_ + 3u * static_cast<std::uint64_t>(set) + index);
  }

  Randomisation make(std::uint32_t set) const {
    const __m128i scrambles =
        _mm_set_epi64x(static_cast<long long>(word(set, 1)), static_cast<long long>(word(set, 0)));
    for (std::uint32_t table = 0; table < joint_.count; ++table) {
      if (joint_.sets[table] == set) {
        return {scrambles, joint_shuffle_, table};
      }
    }
    return {scrambles, static_cast<std::uint32_t>(word(set, 2)), 0};
  }

  SequenceKind kind_;
  std::array<std::uint32_t, 2> key_;
  std::uint32_t pixel_;
  std::uint32_t known_ = 0;
  std::uint64_t hash_;
  JointSets joint_;
  std::uint32_t joint_shuffle_;
  std::array<Randomisation, kBranches * kRemembered> remembered_;
};

class PhotonSequence {
 public:
  PhotonSequence(PixelSequence& pixel, std::uint32_t sample)
      : pixel_(&pixel), reversed_sample_(reverse_bits(sample)) {}

  /// The next four dimensions.
  Uniform4 next() {
    if (pixel_->kind() == SequenceKind::kIndependent) {
      return to_unit(pixel_->independent(reverse_bits(reversed_sample_), set_++));
    }
    const Point point = next_point();
    const __m256i alone = _mm256_castsi128_si256(point.fractions);
    return to_unit(_mm256_castsi256_si128(
        reverse_bits(nested_hash(alone, _mm256_castsi128_si256(point.scrambles)))));
  }

  /// Past the numbers of so many calls of `next`.
  void skip(std::uint32_t sets) { set_ += sets; }

  /// The next four dimensions of many photons, as `next` gives them: sequence_of(i) for each i
  /// below `count`. Two at a time go through one register.
  template <class SequenceOf>
  static void next_of_each(std::size_t count, const SequenceOf& sequence_of, Uniform4* numbers) {
    std::size_t i = 0;
    for (; i + 2 <= count; i += 2) {
      PhotonSequence& one = sequence_of(i);
      if (one.pixel_->kind() == SequenceKind::kIndependent) break;
      const Point a = one.next_point(), b = sequence_of(i + 1).next_point();
      const __m256i fractions = _mm256_set_m128i(b.fractions, a.fractions);
      const __m256i scrambles = _mm256_set_m128i(b.scrambles, a.scrambles);
      _mm256_storeu_ps(numbers[i].data(), to_unit(reverse_bits(nested_hash(fractions, scrambles))));
    }
    for (; i < count; ++i) numbers[i] = sequence_of(i).next();
  }

  /// Numbers of a photon that leaves this one's path: they have nothing in common with the numbers
  /// that follow here. The number is 1 to 255, a branch of a branch being the sum of both.
  PhotonSequence branch(std::uint32_t number) const {
    PhotonSequence other = *this;
    other.set_ += number << PixelSequence::kBranchBits;
    return other;
  }

 private:
  /// Of the Sobol sequence, reversed, and the scrambling left to do to it.
  struct Point {
    __m128i fractions, scrambles;
  };
  Point next_point() {
    const auto randomisation = pixel_->randomisation(set_++);
    return {sobol4(randomisation.table, nested_hash(reversed_sample_, randomisation.shuffle)),
            randomisation.scrambles};
  }

  PixelSequence* pixel_;
  std::uint32_t reversed_sample_, set_ = 0;
};

}  // namespace nocturne

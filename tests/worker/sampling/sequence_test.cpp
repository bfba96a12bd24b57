#include "sampling/sequence.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>
#include <vector>

namespace nocturne {
namespace {

// Known answers published with Random123 (Salmon et al. 2011), philox4x32 with 10 rounds.
TEST(Philox, GivesThePublishedWords) {
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}),
            (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// The fast method keeps bits reversed and takes whole bytes of the index, four dimensions at once.
// It must equal the definitions, bit by bit: a point is the xor of the direction numbers of its
// index's bits; an Owen scramble is a nested hash between two reversals.
TEST(Sobol, PointsAreThoseOfTheDefinition) {
  const auto directions = sobol_direction_numbers();
  const auto scramble = [](std::uint32_t x, std::uint32_t seed) {
    return reverse_bits(nested_hash(reverse_bits(x), seed));
  };
  const JointSets joint{{4, 1, 7}, 3};
  for (std::uint32_t sample = 0; sample < 3000; ++sample) {
    PixelSequence numbers(SequenceKind::kSobol, 7, sample % 5,
                          sample % 2 == 0 ? joint : JointSets{});
    const std::uint32_t index = sample < 2000 ? sample : sample * 2654435761u;
    PhotonSequence sequence(numbers, index);
    for (std::uint32_t set = 0; set < 10; ++set) {
      const Uniform4 u = sequence.next();
      const auto randomisation = numbers.randomisation(set);
      const std::uint32_t shuffled = scramble(index, randomisation.shuffle);
      const auto seeds = std::bit_cast<std::array<std::uint32_t, 4>>(randomisation.scrambles);
      for (std::size_t d = 0; d < 4; ++d) {
        std::uint32_t point = 0;
        for (std::size_t bit = 0; bit < 32; ++bit) {
          if ((shuffled >> bit) & 1u) point ^= directions[4 * randomisation.table + d][bit];
        }
        ASSERT_EQ(u[d], to_unit(scramble(point, seeds[d])));
      }
    }
  }
}

// Point 1000 in the order of Gray's code, as SciPy 1.17's scipy.stats.qmc.Sobol(12, bits=32) gives
// it by the same direction numbers.
TEST(Sobol, DirectionsAreThePublishedOnes) {
  constexpr std::uint32_t kIndex = 1000 ^ (1000 >> 1);
  const auto directions = sobol_direction_numbers();
  std::vector<std::uint32_t> point(kSobolDimensions);
  for (std::size_t d = 0; d < kSobolDimensions; ++d) {
    for (std::size_t bit = 0; bit < 32; ++bit) {
      if ((kIndex >> bit) & 1u) point[d] ^= directions[d][bit];
    }
  }
  EXPECT_EQ(point, (std::vector<std::uint32_t>{943718400u, 415236096u, 2227175424u, 2906652672u,
                                               1203765248u, 3896508416u, 197132288u, 3862953984u,
                                               2151677952u, 297795584u, 364904448u, 1094713344u}));
}

// Each pixel's first 2^k numbers of any dimension fall one into each of 2^k equal intervals;
// dimensions 0 and 1 together fill every elementary rectangle of area 2^-k: the definition of a (0,
// k, 2)-net, which Owen scrambling keeps.
TEST(Sobol, PointsAreNetsAfterScrambling) {
  constexpr std::uint32_t kLog = 8, kCount = 1u << kLog;
  for (const std::uint32_t set : {0u, 1u, 7u}) {
    std::vector<Uniform4> points;
    for (std::uint32_t sample = 0; sample < kCount; ++sample) {
      PixelSequence numbers(SequenceKind::kSobol, 5, 123);
      PhotonSequence sequence(numbers, sample);
      Uniform4 u{};
      for (std::uint32_t s = 0; s <= set; ++s) u = sequence.next();
      points.push_back(u);
    }
    for (std::size_t d = 0; d < 4; ++d) {
      std::set<int> cells;
      for (const auto& u : points) cells.insert(static_cast<int>(u[d] * kCount));
      EXPECT_EQ(cells.size(), kCount) << "dimension " << d << " of set " << set;
    }
    for (std::uint32_t a = 0; a <= kLog; ++a) {
      std::set<std::pair<int, int>> cells;
      for (const auto& u : points) {
        cells.insert({static_cast<int>(u[0] * static_cast<float>(1u << a)),
                      static_cast<int>(u[1] * static_cast<float>(1u << (kLog - a)))});
      }
      EXPECT_EQ(cells.size(), kCount) << "2^" << a << " columns of set " << set;
    }
  }
}

// What makes it worth having: on a smooth integrand the error falls much faster than 1/sqrt(N).
TEST(Sobol, IntegratesASmoothFunctionBetterThanIndependentNumbers) {
  const auto error = [](SequenceKind kind) {
    double squares = 0.0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
      double sum = 0.0;
      for (std::uint32_t sample = 0; sample < 1024; ++sample) {
        PixelSequence numbers(kind, 1, pixel);
        PhotonSequence sequence(numbers, sample);
        sequence.next();
        const Uniform4 u = sequence.next();
        sum += std::sin(3.0 * u[0]) * u[1] + u[2] * u[3];
      }
      const double truth = (1.0 - std::cos(3.0)) / 3.0 * 0.5 + 0.25;
      const double deviation = sum / 1024.0 - truth;
      squares += deviation * deviation;
    }
    return std::sqrt(squares / 64.0);
  };
  EXPECT_LT(error(SequenceKind::kSobol), 0.1 * error(SequenceKind::kIndependent));
}

// What sets gain that are dimensions of one sequence: functions of both are no longer as if the
// numbers of one were independent of the other's.
TEST(Sobol, JointSetsIntegrateAFunctionOfBothBetterThanOthers) {
  const auto error = [](const JointSets& joint) {
    double squares = 0.0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
      double sum = 0.0;
      for (std::uint32_t sample = 0; sample < 1024; ++sample) {
        PixelSequence numbers(SequenceKind::kSobol, 1, pixel, joint);
        PhotonSequence sequence(numbers, sample);
        const Uniform4 u = sequence.next(), v = sequence.next(), w = sequence.next();
        sum += (u[0] - 0.5) * (v[1] - 0.5) + (v[0] - 0.5) * (w[1] - 0.5);
      }
      squares += sum / 1024.0 * (sum / 1024.0);
    }
    return std::sqrt(squares / 64.0);
  };
  EXPECT_LT(error({{0, 1, 2}, 3}), 0.3 * error({}));
}

// A pixel that uses another's dimension, as pixels of a block use its wavelengths, is still
// stratified: a function of that dimension and of the pixel's own numbers has less error.
TEST(Sobol, PixelsThatAreShuffledAlikeCanHaveEachOthersNumbers) {
  const auto error = [](const JointSets& joint) {
    double squares = 0.0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
      double sum = 0.0;
      for (std::uint32_t sample = 0; sample < 1024; ++sample) {
        PixelSequence own(SequenceKind::kSobol, 1, pixel, joint);
        PixelSequence of_block(SequenceKind::kSobol, 1, pixel | (1u << 31), joint);
        const Uniform4 u = PhotonSequence(own, sample).next();
        const Uniform4 v = PhotonSequence(of_block, sample).next();
        sum += (u[0] - 0.5) * (v[2] - 0.5) + (u[1] - 0.5) * (v[2] - 0.5);
      }
      squares += sum / 1024.0 * (sum / 1024.0);
    }
    return std::sqrt(squares / 64.0);
  };
  EXPECT_LT(error({.sets = {0, 1}, .count = 2, .alike = true}), 0.3 * error({{0, 1}, 2}));
}

// Over many pixels every single sample is uniform and two sets are uncorrelated: no bias, whatever
// the sample index.
TEST(Sequence, IsUniformAndUncorrelatedOverPixels) {
  constexpr int kPixels = 200'000;
  for (const auto kind : {SequenceKind::kSobol, SequenceKind::kIndependent}) {
    double sum = 0.0, product = 0.0;
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
      PixelSequence numbers(kind, 9, pixel);
      PhotonSequence sequence(numbers, 3);
      const Uniform4 u = sequence.next(), v = sequence.next();
      sum += u[1] - 0.5;
      product += (u[1] - 0.5) * (v[1] - 0.5);
    }
    // 4 sigma, sigma^2 of u is 1/12, of the product 1/144.
    EXPECT_LT(std::fabs(sum / kPixels), 4.0 * std::sqrt(1.0 / 12.0 / kPixels));
    EXPECT_LT(std::fabs(product / kPixels), 4.0 / 12.0 / std::sqrt(kPixels));
  }
}

// Many at once have the numbers that each has by itself, an odd one out, too.
TEST(Sequence, ManyAtOnceAreThoseOfEach) {
  for (const SequenceKind kind : {SequenceKind::kSobol, SequenceKind::kIndependent}) {
    std::vector<PixelSequence> pixels;
    for (std::uint32_t i = 0; i < 7; ++i) pixels.emplace_back(kind, 11, 100 + i);
    std::vector<PhotonSequence> together, alone;
    for (std::uint32_t i = 0; i < 7; ++i) {
      together.emplace_back(pixels[i], 5 * i);
      alone.emplace_back(pixels[i], 5 * i);
    }
    for (int set = 0; set < 12; ++set) {
      std::array<Uniform4, 7> u;
      PhotonSequence::next_of_each(
          u.size(), [&](std::size_t i) -> PhotonSequence& { return together[i]; }, u.data());
      for (std::size_t i = 0; i < u.size(); ++i) EXPECT_EQ(u[i], alone[i].next());
    }
  }
}

TEST(Sequence, FractionsAreRoundedOnceAndNeverReachOne) {
  for (const std::uint32_t bits : {0u, 1u, 0xFFFFu, 0x10000u, 0x1000001u, 0x7FFFFFFFu, 0x80000000u,
                                   0xFFFFFF7Fu, 0xFFFFFF80u, ~0u}) {
    const float unit = to_unit(_mm_set1_epi32(static_cast<int>(bits)))[3];
    EXPECT_EQ(unit, to_unit(bits)) << bits;
    EXPECT_LT(unit, 1.0f);
  }
}

}  // namespace
}  // namespace nocturne

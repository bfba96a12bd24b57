// How photons that clear glass or mirrors never let go end.
#include <gtest/gtest.h>

#include "tracer/vertex/roulette.h"

namespace nocturne {
namespace {

// Along the rim of a fine mesh of glass about one photon in n gets out after n surfaces. By a
// constant survival of 0.99 next to none were left after 3000, and those carried 5e8.
TEST(CaughtPhotons, WeightsGrowAsTheSquareOfTheNumberOfSurfaces) {
  constexpr std::uint32_t kAfter = TracingOptions::kSpecularRouletteAfter, kLong = 30 * kAfter;
  PixelSequence numbers(SequenceKind::kIndependent, 1, 0);
  Group<1> group{PhotonSequence(numbers, 0)};
  double kept = 1.0;
  for (std::uint32_t n = 1; n <= kLong; ++n) {
    group.depth = group.consecutive_specular = n;
    kept *= static_cast<double>(survival_of_many(group));
    if (n == kAfter) {
      EXPECT_EQ(kept, 1.0);
    }
  }
  EXPECT_NEAR(kept, 1.0 / 900.0, 1e-5);
}

// A path that comes to the end of its rays loses its light without any other taking it over.
TEST(CaughtPhotons, EndBeforeTheirRaysDo) {
  PixelSequence numbers(SequenceKind::kIndependent, 1, 0);
  Group<1> caught{PhotonSequence(numbers, 0)}, many = caught;
  double of_caught = 1.0, of_many = 1.0;
  for (std::uint32_t n = 1; n <= PathLimits::kMaxRays; ++n) {
    caught.depth = caught.consecutive_specular = many.depth = n;
    of_caught *= static_cast<double>(survival_of_many(caught));
    of_many *= static_cast<double>(survival_of_many(many));
  }
  EXPECT_LT(of_caught, 1e-10);
  EXPECT_LT(of_many, 1e-6);
}

}  // namespace
}  // namespace nocturne

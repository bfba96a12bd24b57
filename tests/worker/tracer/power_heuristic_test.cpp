#include "tracer/vertex/power_heuristic.h"

#include <gtest/gtest.h>

namespace nocturne {
namespace {

TEST(PowerHeuristic, SharesAddUpToOneWhateverTheDensities) {
  for (const float own : {1e-30f, 1e-6f, 0.3f, 7.0f, 1e9f, 1e30f}) {
    for (const float other : {1e-30f, 1e-6f, 0.3f, 7.0f, 1e9f, 1e30f}) {
      const float one = power_share(Spectral<1>(own), Spectral<1>(other))[0];
      const float rest = power_share(Spectral<1>(other), Spectral<1>(own))[0];
      EXPECT_NEAR(one + rest, 1.0f, 2e-7f) << own << ", " << other;
    }
  }
}

TEST(PowerHeuristic, GoesByTheSquaresOfDensities) {
  const Spectral<4> share = power_share(Spectral<4>(3.0f), Spectral<4>(1.0f));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(share[i], 0.9f);
}

// As in a lane that parted from the others at a facet which sends it nowhere.
TEST(PowerHeuristic, WhatCouldNotHaveComeHasNoShare) {
  for (const float other : {0.0f, 1e-30f, 2.0f}) {
    EXPECT_EQ(power_share(Spectral<1>(0.0f), Spectral<1>(other))[0], 0.0f);
  }
}

TEST(PowerHeuristic, WhatNoOtherCanBringHasTheWholeShare) {
  EXPECT_EQ(power_share(Spectral<1>(0.25f), Spectral<1>(0.0f))[0], 1.0f);
}

}  // namespace
}  // namespace nocturne

// Elements that are distinct under any rounding.
#include "luminaires/apart.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace nocturne {
namespace {

// A square of 1 m that emits down.
void add_square(Elements& elements, Vec3 corner) {
  const std::vector<std::array<Vec3, 3>> corners{
      {corner, corner + Vec3{0, 1, 0}, corner + Vec3{1, 0, 0}}};
  elements.add_parallelogram(corners, {.radiance = 1.0f});
}

TEST(ApartUpTo, OneAloneAnywhere) {
  Elements elements;
  add_square(elements, {0, 0, 0});
  const std::vector<float> up_to = apart_up_to(elements);
  ASSERT_EQ(up_to.size(), 1u);
  EXPECT_GT(up_to[0], 0.0f);
  EXPECT_TRUE(std::isinf(up_to[0]));
}

TEST(ApartUpTo, NeighboursThatTouchNowhere) {
  Elements elements;
  add_square(elements, {0, 0, 0});
  add_square(elements, {1, 0, 0});
  for (const float distance : apart_up_to(elements)) EXPECT_LT(distance, 0.0f);
}

// Rounding moves a direction by 2^-24 or so: by 6 mm in 100 km.
TEST(ApartUpTo, OthersAsFarAsTheyAreFarFromEachOther) {
  Elements elements;
  add_square(elements, {0, 0, 0});
  add_square(elements, {1.5f, 0, 0});
  add_square(elements, {1.5f, 0, 100.0f});
  const std::vector<float> up_to = apart_up_to(elements);
  ASSERT_EQ(up_to.size(), 3u);
  EXPECT_NEAR(up_to[0], 0.5 * 0x1p17, 5.0);
  EXPECT_EQ(up_to[1], up_to[0] - 1.5f);  // as far as it lies from the origin
  EXPECT_GT(up_to[2], 100.0f * up_to[0]);
}

TEST(ApartUpTo, NothingFarFromTheOrigin) {
  Elements elements;
  add_square(elements, {1e6f, 0, 0});
  add_square(elements, {1e6f + 1.5f, 0, 0});
  for (const float distance : apart_up_to(elements)) EXPECT_LT(distance, 0.0f);
}

}  // namespace
}  // namespace nocturne

// The same job gives the same bits, and cuts don't matter beyond the order of addition that the
// plan fixes.
#include <gtest/gtest.h>
#include <immintrin.h>

#include "support/caustic_scene.h"
#include "support/scene_builder.h"
#include "tracer/trace_film.h"

namespace nocturne {
namespace {

std::shared_ptr<const Scene> room() {
  test::SceneBuilder builder;
  builder.add_furnace(0.5f, 0.0f);
  builder.add_sphere(0.2f, 20.0f, {0.4f, 0.5f, -0.3f}, 0.2);
  return builder.load();
}

constexpr Film kFilm{40, 24};

TEST(Bits, SameJobSameBits) {
  const auto scene = room();
  const TileRange range{8, 4, 16, 16, 4, 12};
  EXPECT_EQ(trace_tile(*scene, kFilm, range).sums, trace_tile(*room(), kFilm, range).sums);
}

TEST(Bits, ASampleDoesNotDependOnTheTileAroundIt) {
  const auto scene = room();
  const TileSums large = trace_tile(*scene, kFilm, {0, 0, 40, 24, 3, 4});
  const TileSums one = trace_tile(*scene, kFilm, {17, 9, 1, 1, 3, 4});
  for (std::size_t c = 0; c < one.channels; ++c) {
    EXPECT_EQ(one.sums[c], large.sums[one.channels * (9 * 40 + 17) + c]);
  }
}

TEST(Bits, SizeOfBatchesDoesNotMatter) {
  const auto scene = room();
  const TileRange range{8, 4, 16, 16, 4, 12};
  const auto traced = [&](std::uint32_t groups) {
    const TileSums tile = trace_tile(*scene, kFilm, range, groups);
    return std::pair{tile.sums, tile.block_products};
  };
  const auto sums = traced(2048);
  EXPECT_EQ(traced(256), sums);
  EXPECT_EQ(traced(7), sums);
  EXPECT_EQ(traced(1), sums);
}

// A lamp in a ball of glass in a box of thin fog: every photon is connected to the camera, which is
// outside of the box, from several places.
TEST(Bits, SizeOfBatchesDoesNotMatterToForwardPhotonsInFog) {
  auto builder = test::floor_and_lamp(true);
  test::SceneBuilder::set(*builder.message.mutable_surfaces(1)->mutable_sphere()->mutable_centre(),
                          {0, -0.2f, -0.5f});
  const auto fog = builder.add_medium(builder.add_spectrum(0.1f), builder.add_spectrum(0.4f), 0.5);
  builder.add_matched_box({-1.5f, -0.9f, -1.5f}, {1.5f, 2.5f, 1.5f}, {fog});
  const auto scene = builder.load();
  const auto traced = [&](std::uint32_t groups) {
    return trace_tile(*scene, {16, 16}, {0, 0, 16, 16, 0, 32}, groups).sums;
  };
  const auto sums = traced(2048);
  EXPECT_EQ(traced(256), sums);
  EXPECT_EQ(traced(1), sums);
}

TEST(Bits, NumberOfThreadsDoesNotMatter) {
  const auto scene = room();
  const std::vector<std::uint32_t> ends{4, 8, 16, 20};
  const auto trace = [&](unsigned threads) {
    double last = 0.0;
    TileSums image = trace_film(*scene, {kFilm, 16, ends}, threads, [&](double share) {
                       EXPECT_GT(share, last);
                       last = share;
                     }).first;
    EXPECT_DOUBLE_EQ(last, 1.0);
    return image;
  };
  const TileSums one = trace(1);
  const TileSums three = trace(3);
  EXPECT_EQ(one.sums, three.sums);
  EXPECT_EQ(one.block_products, three.block_products);
  EXPECT_EQ(one.tile_products, three.tile_products);
  EXPECT_EQ(one.photons, 40u * 24u * 20u);
  EXPECT_GT(one.rays, one.photons);
  EXPECT_EQ(one.invalid_samples, 0u);
}

TEST(Bits, TracingLeavesTheFloatingPointModeAlone) {
  const unsigned before = _mm_getcsr() & ~0x3Fu;
  trace_tile(*room(), kFilm, {0, 0, 4, 4, 0, 1});
  EXPECT_EQ(_mm_getcsr() & ~0x3Fu, before);
}

}  // namespace
}  // namespace nocturne

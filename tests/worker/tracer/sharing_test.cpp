// Blocks of pixels that share what their photons find. That the image is the same is for
// tests/accuracy/test_sharing.py.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "support/scene_builder.h"
#include "tracer/sharing/sharing_blocks.h"
#include "tracer/trace_film.h"

namespace nocturne {
namespace {

TEST(SharingBlocks, HoldEachSampleOfEachPixelOnce) {
  const TileRange tile{7, 3, 21, 10, 5, 70};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> samples;
  for_each_sharing_block(tile, [&](const SharingBlock& block) {
    EXPECT_LE(block.width, kSharingSide);
    EXPECT_LE(block.height, kSharingSide);
    EXPECT_EQ(sharing_run(block.first_sample).index, sharing_run(block.end_sample - 1).index);
    for (std::uint32_t y = block.y; y < block.y + block.height; ++y) {
      for (std::uint32_t x = block.x; x < block.x + block.width; ++x) {
        for (std::uint32_t s = block.first_sample; s < block.end_sample; ++s) {
          samples[{x, y}].push_back(s);
        }
      }
    }
  });
  std::vector<std::uint32_t> all;
  for (std::uint32_t s = tile.first_sample; s < tile.end_sample; ++s) all.push_back(s);
  EXPECT_EQ(samples.size(), std::size_t{tile.width} * tile.height);
  for (const auto& [pixel, found] : samples) {
    EXPECT_GE(pixel.first, tile.x);
    EXPECT_LT(pixel.first, tile.x + tile.width);
    EXPECT_GE(pixel.second, tile.y);
    EXPECT_LT(pixel.second, tile.y + tile.height);
    EXPECT_EQ(found, all);
  }
}

TEST(SharingBlocks, StandAsLongAsAllBefore) {
  std::uint32_t index = 0;
  for (std::uint32_t first = 0; first < 1u << 20; first = sharing_run(first).end) {
    const SharingRun run = sharing_run(first);
    EXPECT_EQ(run.index, index++);
    EXPECT_EQ(run.first, first);
    EXPECT_EQ(run.end, first == 0 ? 32 : 2 * first);
    EXPECT_EQ(sharing_run(run.end - 1).first, first);
  }
  constexpr std::uint32_t kLast = (1u << 31) - 1;  // the most samples
  EXPECT_EQ(sharing_run(kLast).first, 1u << 30);
  EXPECT_EQ(sharing_run(kLast).end, 1u << 31);
}

// Each pixel's run begins at a multiple of its length and so does the block's: nets.
TEST(SharingBlocks, NumbersOfPixelsLieTogether) {
  std::set<std::uint32_t> all;
  for (std::uint32_t sample = 0; sample < 256; ++sample) {
    const SharingRun run = sharing_run(sample);
    const std::uint32_t length = run.end - run.first;
    for (std::uint32_t place = 0; place < kSharingPixels; ++place) {
      const std::uint32_t number = number_in_block(sample, place);
      all.insert(number);
      EXPECT_EQ(number % length, sample - run.first);
      EXPECT_EQ(number / length, number_in_block(run.first, place) / length);
    }
  }
  EXPECT_EQ(all.size(), 256 * kSharingPixels);
  EXPECT_EQ(*all.rbegin(), 256 * kSharingPixels - 1);
}

TEST(SharingBlocks, StandInAllPlacesInTurn) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> shifts;
  for (std::uint32_t run = 0; run < kSharingPixels; ++run) {
    const SharingShift shift = sharing_shift(run);
    EXPECT_LT(std::max(shift.x, shift.y), kSharingSide);
    shifts.insert({shift.x, shift.y});
  }
  EXPECT_EQ(shifts.size(), kSharingPixels);
}

std::shared_ptr<const Scene> room(std::uint32_t sharing) {
  test::SceneBuilder builder;
  builder.message.mutable_tracing()->set_sharing(sharing);
  builder.message.mutable_tracing()->set_estimator(nocturne::v1::ESTIMATOR_TWO_PHOTONS);
  builder.add_furnace(0.5f, 0.0f);
  builder.add_sphere(0.2f, 20.0f, {0.4f, 0.5f, -0.3f}, 0.2);
  return builder.load();
}

TEST(Sharing, BitsDoNotDependOnBatchesAndThreads) {
  constexpr Film kFilm{40, 24};
  const auto scene = room(16);
  const auto traced = [&](std::uint32_t groups) {
    const TileSums tile = trace_tile(*scene, kFilm, {8, 4, 18, 15, 4, 40}, groups);
    return std::tuple{tile.sums, tile.block_products, tile.rays};
  };
  const auto sums = traced(2048);
  EXPECT_EQ(traced(256), sums);
  EXPECT_EQ(traced(7), sums);  // fewer than a block

  const std::vector<std::uint32_t> ends{4, 20};
  const auto film = [&](unsigned threads) {
    return trace_film(*scene, {kFilm, 16, ends}, threads, [](double) {}).first;
  };
  EXPECT_EQ(film(1).sums, film(3).sums);
}

TEST(Sharing, AsksMoreRaysOfNeighboursThanOfPixelsAlone) {
  const TileRange tile{0, 0, 16, 16, 0, 4};
  const auto rays = [&](std::uint32_t sharing) {
    return trace_tile(*room(sharing), Film{16, 16}, tile).rays;
  };
  EXPECT_GT(rays(16), rays(1));
}

}  // namespace
}  // namespace nocturne

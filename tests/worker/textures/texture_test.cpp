#include "textures/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <thread>
#include <vector>

#include "support/texture_files.h"

namespace nocturne {
namespace {

using test::Picture;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float numbered(int x, int y) { return static_cast<float>(1 + x + 8 * y); }

class Textures : public testing::Test {
 protected:
  Texture make(const Picture& picture, TextureWrap wrap = TextureWrap::kRepeat) {
    return Texture(files_.write(picture), picture.channels, wrap);
  }
  test::TextureFiles files_;
};

TEST_F(Textures, TexelCentresHoldTheTexelsFromTheBottomUp) {
  const Texture texture = make(Picture::of(8, 4, numbered));
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / 8.0f;
      const float v = 1.0f - (static_cast<float>(y) + 0.5f) / 4.0f;
      EXPECT_FLOAT_EQ(texture.grey(u, v, 0.0f), numbered(x, y)) << x << ' ' << y;
    }
  }
}

TEST_F(Textures, InterpolatesBilinearly) {
  const Texture texture = make(Picture::of(8, 4, numbered));
  // Between texels (2, 1), (3, 1), (2, 2), (3, 2): 11, 12, 19, 20.
  EXPECT_FLOAT_EQ(texture.grey(3.0f / 8.0f, 0.5f, 0.0f), 15.5f);
  EXPECT_FLOAT_EQ(texture.grey(2.75f / 8.0f, 1.0f - 1.5f / 4.0f, 0.0f), 11.25f);
}

TEST_F(Textures, SharpOnesKnowNoFootprint) {
  const auto path = files_.write(Picture::of(8, 4, numbered));
  const Texture filtered(path, 1, TextureWrap::kRepeat);
  const Texture sharp(path, 1, TextureWrap::kRepeat, TextureFilter::kSharp);
  EXPECT_GT(filtered.grey(0.5f / 8.0f, 0.875f, 1.0f), 15.0f);  // nearly the mean of 1 to 32
  EXPECT_FLOAT_EQ(sharp.grey(0.5f / 8.0f, 0.875f, 1.0f), 1.0f);
}

TEST_F(Textures, RepeatsOrHoldsTheEdge) {
  const Picture picture = Picture::of(8, 4, numbered);
  const Texture repeated = make(picture), held = make(picture, TextureWrap::kClamp);
  const float v = 1.0f - 0.5f / 4.0f;  // the top row: 1 to 8
  EXPECT_FLOAT_EQ(repeated.grey(3.0f + 1.5f / 8.0f, v - 2.0f, 0.0f), 2.0f);
  EXPECT_FLOAT_EQ(repeated.grey(-0.5f / 8.0f, v, 0.0f), 8.0f);
  EXPECT_FLOAT_EQ(repeated.grey(1.0f, v, 0.0f), 4.5f);  // between 8 and 1
  EXPECT_FLOAT_EQ(held.grey(1.0f, v, 0.0f), 8.0f);
  EXPECT_FLOAT_EQ(held.grey(7.0f, 9.0f, 0.0f), 8.0f);
  EXPECT_FLOAT_EQ(held.grey(-7.0f, 9.0f, 0.0f), 1.0f);
}

TEST_F(Textures, CoordinatesThatAreNoNumbersAreZero) {
  const Texture texture = make(Picture::of(8, 4, numbered));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float x : {nan, kInfinity, -kInfinity}) {
    EXPECT_EQ(texture.grey(x, x, x), texture.grey(0.0f, 0.0f, x > 0.0f ? 1.0f : 0.0f));
  }
  EXPECT_TRUE(std::isfinite(texture.grey(1e30f, -1e30f, 0.0f)));
}

TEST_F(Textures, WideFootprintsSeeMeans) {
  const Texture checker =
      make(Picture::of(64, 64, [](int x, int y) { return static_cast<float>((x + y) % 2); }));
  EXPECT_FLOAT_EQ(checker.mean()[0], 0.5f);
  EXPECT_FLOAT_EQ(checker.grey(0.5f / 64.0f, 1.0f - 0.5f / 64.0f, 0.0f), 0.0f);
  for (const float width : {2.0f / 64.0f, 0.1f, 1.0f, 5.0f, kInfinity}) {
    EXPECT_FLOAT_EQ(checker.grey(0.5f / 64.0f, 1.0f - 0.5f / 64.0f, width), 0.5f) << width;
  }
  // One texel wide: the finest level. In between, a mixture.
  EXPECT_FLOAT_EQ(checker.grey(0.5f / 64.0f, 1.0f - 0.5f / 64.0f, 1.0f / 64.0f), 0.0f);
  const float between = checker.grey(0.5f / 64.0f, 1.0f - 0.5f / 64.0f, 1.5f / 64.0f);
  EXPECT_GT(between, 0.05f);
  EXPECT_LT(between, 0.45f);
}

TEST_F(Textures, KeepsColoursInOrder) {
  Picture picture{3, 2, 3, {}};
  for (int i = 0; i < 18; ++i) picture.values.push_back(static_cast<float>(i));
  const Texture texture = make(picture);
  EXPECT_EQ(texture.channels(), 3);
  const auto rgb = texture.rgb(0.5f, 0.25f, 0.0f);  // bottom row, middle
  EXPECT_FLOAT_EQ(rgb[0], 12.0f);
  EXPECT_FLOAT_EQ(rgb[1], 13.0f);
  EXPECT_FLOAT_EQ(rgb[2], 14.0f);
  EXPECT_NEAR(texture.mean()[1], 8.5f, 1e-5f);
}

TEST_F(Textures, OneTexelIsATexture) {
  const Texture texture = make({1, 1, 1, {0.25f}});
  EXPECT_EQ(texture.grey(0.3f, 0.9f, 0.2f), 0.25f);
}

// What memory holds, and which thread asks, change nothing: 1024 x 1024 floats and their coarser
// levels are more than fit.
TEST_F(Textures, AnyThreadAndAnyCacheGivesTheSameBits) {
  const Picture picture = Picture::of(1024, 1024, [](int x, int y) {
    return std::sin(0.37f * static_cast<float>(x)) * std::cos(0.11f * static_cast<float>(y));
  });
  const Texture warm = make(picture), cold = make(picture);
  const auto look_up = [](const Texture& texture) {
    std::vector<float> found;
    std::uint32_t state = 1;
    const auto next = [&] {
      state = state * 1664525u + 1013904223u;
      return static_cast<float>(state >> 8) * 0x1p-24f;
    };
    for (int i = 0; i < 10000; ++i) {
      const float u = next(), v = next(), width = next();
      found.push_back(texture.grey(u, v, width * width * width * 0.01f));
    }
    return found;
  };
  constexpr std::uint64_t kSmall = 2 << 20;
  set_texture_memory(kSmall);
  std::vector<std::vector<float>> found(4);
  {
    std::vector<std::jthread> threads;
    for (auto& mine : found) threads.emplace_back([&] { mine = look_up(cold); });
  }
  // The image library keeps a megabyte at least, and each thread a tile or two in its hand.
  EXPECT_LE(texture_memory_used(), kSmall + (kSmall >> 1));
  set_texture_memory(kTextureMemoryBytes);
  look_up(warm);
  const std::vector<float> expected = look_up(warm);
  EXPECT_GT(texture_memory_used(), 4u << 20);
  for (const auto& mine : found) {
    EXPECT_EQ(std::memcmp(mine.data(), expected.data(), 4 * expected.size()), 0);
  }
}

class DamagedTextures : public Textures {
 protected:
  void expect_refused(const std::filesystem::path& path, const std::string& says,
                      int channels = 1) {
    try {
      Texture(path, channels, TextureWrap::kRepeat);
      ADD_FAILURE() << "accepted: " << says;
    } catch (const TextureError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
};

TEST_F(DamagedTextures, AreRefusedInWords) {
  const Picture picture = Picture::of(70, 70, numbered);
  expect_refused(files_.next_path(), "no image");
  const auto text = files_.next_path();
  std::ofstream(text) << "not a picture";
  expect_refused(text, "no image");
  expect_refused(files_.write_plain(picture), "");
  expect_refused(files_.write(picture), "channels", 3);
  expect_refused(files_.write(picture), "neither 1 nor 3", 2);
  const auto cut = files_.write(picture);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  expect_refused(cut, "");
  auto infinite = picture;
  infinite.values[5] = kInfinity;
  expect_refused(files_.write(infinite), "");
}

TEST_F(DamagedTextures, AGoodFileMayComeToTheSamePlace) {
  const auto path = files_.next_path();
  std::ofstream(path) << "not a picture";
  expect_refused(path, "no image");
  std::filesystem::rename(files_.write(Picture::of(8, 4, numbered)), path);
  EXPECT_FLOAT_EQ(Texture(path, 1, TextureWrap::kRepeat).mean()[0], 16.5f);
}

// A tile that can't be read is found when it is looked up.
TEST_F(DamagedTextures, ThrowWhereTilesCantBeRead) {
  // Few values, so that tiles are compressed: damage then is no picture any more.
  const Picture picture = Picture::of(
      256, 256, [](int x, int y) { return static_cast<float>((x * x + 7 * y * y + x * y) % 11); });
  const auto path = files_.write(picture);
  {
    const auto size = std::filesystem::file_size(path);
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(size / 4));
    file << std::string(size / 20, '\x5a');
  }
  const Texture texture(path, 1, TextureWrap::kRepeat);
  int thrown = 0;
  for (int i = 0; i < 16; ++i) {
    try {
      texture.grey((static_cast<float>(i % 4) + 0.5f) / 4.0f,
                   (static_cast<float>(i / 4) + 0.5f) / 4.0f, 0.0f);
    } catch (const TextureError&) {
      ++thrown;
    }
  }
  EXPECT_GT(thrown, 0);
  EXPECT_LT(thrown, 16);
}

}  // namespace
}  // namespace nocturne

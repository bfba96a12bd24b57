#include "textures/texture.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/texture_files.h"
#include "textures/texture_file.h"

namespace nocturne {
namespace {

using test::Picture;
using Numbers = TextureFile::Numbers;

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

// A footprint that lies beyond a held edge sees nothing else, however wide it is.
TEST_F(Textures, FootprintsBeyondAHeldEdgeSeeTheEdge) {
  const Texture held = make(Picture::of(8, 4, numbered), TextureWrap::kClamp);
  const float v = 1.0f - 0.5f / 4.0f;  // the top row: 1 to 8
  for (const float width : {0.25f, 0.5f, 1.0f, 2.0f}) {
    EXPECT_FLOAT_EQ(held.grey(1.5f + width, v, width), 8.0f) << width;
    EXPECT_FLOAT_EQ(held.grey(-0.5f - width, v, width), 1.0f) << width;
    EXPECT_FLOAT_EQ(held.grey(0.5f / 8.0f, 1.5f + width, width), 1.0f) << width;
  }
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

// Strips meet at every 64th column; numbers that half and codes hold exactly.
TEST_F(Textures, AnyNumbersAndAnyWidthGiveTheSameTexels) {
  for (const int width : {63, 64, 65, 128, 150}) {
    Picture picture{width, 5, 3, {}};
    for (int i = 0; i < width * 15; ++i) {
      picture.values.push_back(static_cast<float>(i * 7 % 251));
    }
    for (const auto numbers : {Numbers::kCodes, Numbers::kHalf, Numbers::kFloat}) {
      const Texture texture(files_.write(picture, numbers), 3, TextureWrap::kRepeat);
      for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < width; ++x) {
          const auto at = [&](int column, int row) {
            return picture
                .values[static_cast<std::size_t>((row % 5 * width + column % width) * 3 + 1)];
          };
          const float expected =
              0.25f * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1));
          const float u = static_cast<float>(x + 1) / static_cast<float>(width);
          const float v = 1.0f - static_cast<float>(y + 1) / 5.0f;
          ASSERT_NEAR(texture.rgb(u, v, 0.0f)[1], expected, 0.01f) << width << ' ' << x << ' ' << y;
        }
      }
    }
  }
}

TEST_F(Textures, AnyThreadGetsTheSameBits) {
  const Texture texture = make(Picture::of(300, 200, [](int x, int y) {
    return std::sin(0.37f * static_cast<float>(x)) * std::cos(0.11f * static_cast<float>(y));
  }));
  const auto look_up = [&] {
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
  std::vector<std::vector<float>> found(4);
  {
    std::vector<std::jthread> threads;
    for (auto& mine : found) threads.emplace_back([&] { mine = look_up(); });
  }
  for (const auto& mine : found) EXPECT_EQ(mine, look_up());
}

TEST_F(Textures, AreReadAfterTheirFileWasRemoved) {
  const auto path = files_.write(Picture::of(8, 4, numbered));
  const Texture texture(path, 1, TextureWrap::kRepeat);
  std::filesystem::remove(path);
  EXPECT_FLOAT_EQ(texture.mean()[0], 16.5f);
}

// As large as a texture of half may be, 179 MB, where a process may have 32 MiB of memory.
TEST_F(Textures, TakeNoMemoryOfTheirOwn) {
  const auto path = files_.write(Picture::of(1, 1, numbered), Numbers::kHalf);
  constexpr std::uint32_t kWidth = 16384, kHeight = 4096, kLevels = 15;
  std::uintmax_t size = 36;
  for (std::uint32_t i = 0; i < kLevels; ++i) {
    const std::uintmax_t width = kWidth >> i, height = std::max(kHeight >> i, 1u);
    size = (size + 63) / 64 * 64;
    size += (width + 63) / 64 * (std::min<std::uintmax_t>(width, 64) + 1) * (height + 1) * 2;
  }
  {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    for (const auto& [at, number] : {std::pair(12, kWidth), {16, kHeight}, {32, kLevels}}) {
      file.seekp(at);
      file.write(reinterpret_cast<const char*>(&number), sizeof number);
    }
    file.seekp(64);
    file << std::string(2, '\x3c');  // the first texel, 0x3c3c: 1.0586
  }
  std::filesystem::resize_file(path, size);
  rlimit before{};
  getrlimit(RLIMIT_DATA, &before);
  const rlimit little{std::uint64_t{32} << 20, before.rlim_max};
  setrlimit(RLIMIT_DATA, &little);
  const Texture texture(path, 1, TextureWrap::kRepeat);
  EXPECT_NEAR(texture.grey(0.5f / kWidth, 1.0f - 0.5f / kHeight, 0.0f), 1.0586f, 1e-3f);
  for (int i = 1; i < 1000; ++i) {
    EXPECT_EQ(texture.grey(0.001f * static_cast<float>(i), 0.37f * static_cast<float>(i), 0.0f), 0);
  }
  setrlimit(RLIMIT_DATA, &before);
}

class DamagedTextures : public Textures {
 protected:
  static void expect_refused(const std::filesystem::path& path, const std::string& says,
                             int channels = 1) {
    try {
      Texture(path, channels, TextureWrap::kRepeat);
      ADD_FAILURE() << "accepted: " << says;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
  // The one file in memory that holds them now, under the name that workers have for theirs.
  std::filesystem::path put(const std::string& bytes) {
    EXPECT_EQ(ftruncate(memory_, 0), 0);
    EXPECT_EQ(pwrite(memory_, bytes.data(), bytes.size(), 0), std::ssize(bytes));
    return "/proc/self/fd/" + std::to_string(memory_);
  }
  ~DamagedTextures() override { close(memory_); }
  static std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  int memory_ = memfd_create("texture", MFD_CLOEXEC);
};

TEST_F(DamagedTextures, AreRefusedInWords) {
  const Picture picture = Picture::of(70, 70, numbered);
  expect_refused(files_.next_path(), "cannot read");
  expect_refused(std::filesystem::temp_directory_path(), "cannot read");
  expect_refused(put("not a picture"), "no texture file");
  expect_refused(put(""), "no texture file");
  expect_refused(put(std::string("\x76\x2f\x31\x01 as OpenEXR begins")), "compile the scene again");
  expect_refused(files_.write(picture), "channels", 3);
  expect_refused(files_.write(picture), "neither 1 nor 3", 2);
  auto infinite = picture;
  for (const float value : {kInfinity, -kInfinity, std::nanf(""), 2e38f}) {
    infinite.values[5] = value;
    expect_refused(files_.write(infinite), "not finite");
  }
  infinite.values[5] = kInfinity;
  expect_refused(files_.write(infinite, Numbers::kHalf), "not finite");
  const std::string good = bytes_of(files_.write(picture));
  const auto with = [&](std::size_t at, std::uint32_t number) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &number, sizeof number);
    return put(bytes);
  };
  expect_refused(with(8, 2), "version 2, where 1 is read: compile the scene again");
  for (const std::uint32_t edge : {0u, 16385u, ~0u}) {
    expect_refused(with(12, edge), "a size");
    expect_refused(with(16, edge), "a size");
  }
  expect_refused(with(16, 71), "bytes, where its header says");
  expect_refused(with(20, 3), "channels");
  expect_refused(with(24, 3), "kind of numbers");
  expect_refused(with(24, 2), "bytes, where its header says");
  expect_refused(with(28, 1), "kind of numbers");
  expect_refused(with(28, 2), "bytes, where its header says");
  expect_refused(with(32, 6), "all levels");
}

TEST_F(DamagedTextures, AreRefusedIfTheyEndTooEarlyOrTooLate) {
  for (const auto numbers : {Numbers::kCodes, Numbers::kHalf, Numbers::kFloat}) {
    const std::string good = bytes_of(files_.write(Picture::of(70, 9, numbered), numbers));
    for (std::size_t size = 0; size < good.size(); ++size) {
      expect_refused(put(good.substr(0, size)), "texture file");
    }
    expect_refused(put(good + '\0'), "bytes, where its header says");
  }
}

// Any bits of the header and of the pixels after it. A file that is accepted can be looked up
// everywhere.
TEST_F(DamagedTextures, GiveFiniteNumbersOrAreRefused) {
  std::uint32_t state = 1;
  const auto random = [&](std::size_t below) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
  };
  int accepted = 0;
  for (const auto numbers : {Numbers::kCodes, Numbers::kHalf, Numbers::kFloat}) {
    const std::string good = bytes_of(files_.write(Picture::of(70, 9, numbered), numbers));
    for (int round = 0; round < 1000; ++round) {
      std::string bytes = good;
      for (std::size_t i = 0; i <= random(4); ++i) {
        bytes[random(round % 2 == 0 ? 40 : bytes.size())] ^= static_cast<char>(1u << random(8));
      }
      const auto wrap = round % 3 == 0 ? TextureWrap::kClamp : TextureWrap::kRepeat;
      try {
        const Texture texture(put(bytes), 1, wrap);
        ++accepted;
        for (int i = 0; i <= 64; ++i) {
          const float u = static_cast<float>(i) / 64.0f,
                      v = static_cast<float>(i * 29 % 65) / 64.0f;
          EXPECT_TRUE(std::isfinite(texture.grey(u, v, 0.02f * static_cast<float>(i % 9))));
        }
      } catch (const std::invalid_argument&) {
      }
    }
  }
  EXPECT_GT(accepted, 300);
  EXPECT_LT(accepted, 2700);
}

}  // namespace
}  // namespace nocturne

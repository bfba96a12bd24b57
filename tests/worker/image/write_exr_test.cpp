#include "image/write_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <vector>

namespace nocturne {
namespace {

constexpr std::uint32_t kWidth = 3, kHeight = 2, kSamples = 7;
constexpr std::size_t kPixels = kWidth * kHeight;

class WriteExr : public testing::Test {
 protected:
  const std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".exr");

  void TearDown() override { std::filesystem::remove(path_); }

  void write(const std::vector<double>& sums, const std::vector<std::string>& further) const {
    write_exr(path_, kWidth, kHeight, sums, further, kSamples,
              {"5c", "{}", 1, "0123456789abcdef", "illuminance", "lx", "W m-2"});
  }

  std::map<std::string, std::vector<float>> read() const {
    Imf::InputFile file(path_.c_str());
    std::map<std::string, std::vector<float>> channels;
    Imf::FrameBuffer buffer;
    const auto& list = file.header().channels();
    for (auto channel = list.begin(); channel != list.end(); ++channel) {
      auto& values = channels[channel.name()];
      values.resize(kPixels);
      buffer.insert(channel.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()),
                                               sizeof(float), sizeof(float) * kWidth));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(0, kHeight - 1);
    return channels;
  }
};

// Sums whose means tell pixel and channel: 10 x pixel + channel, no variance in Y.
std::vector<double> sums(std::size_t channels) {
  std::vector<double> values;
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    for (std::size_t channel = 0; channel < channels; ++channel) {
      values.push_back(kSamples * static_cast<double>(10 * pixel + channel));
    }
    const double y = values[channels * pixel + 1];
    values[channels * pixel + 3] = y * y / kSamples;
  }
  return values;
}

void expect_means(const std::vector<float>& values, std::size_t channel) {
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    EXPECT_EQ(values[pixel], static_cast<float>(10 * pixel + channel));
  }
}

TEST_F(WriteExr, HoldsMeansErrorsAndCounts) {
  auto values = sums(4);
  values[3] += 42.0 * 9.0;  // pixel 0: variance of the mean 42 x 9 / (7 x 6)
  write(values, {});
  const auto image = read();
  EXPECT_EQ(image.size(), 8u);
  expect_means(image.at("X"), 0);
  expect_means(image.at("Y"), 1);
  expect_means(image.at("Z"), 2);
  EXPECT_EQ(image.at("Y.stderr"), (std::vector<float>{3, 0, 0, 0, 0, 0}));
  EXPECT_EQ(image.at("n"), std::vector<float>(kPixels, kSamples));
}

TEST_F(WriteExr, HasAChannelForEachFurtherResponse) {
  write(sums(6), {"rod", "A.far-red"});
  const auto image = read();
  EXPECT_EQ(image.size(), 10u);
  expect_means(image.at("Z"), 2);
  EXPECT_EQ(image.at("Y.stderr"), std::vector<float>(kPixels, 0));
  expect_means(image.at("rod"), 4);
  expect_means(image.at("A.far-red"), 5);
}

// Viewers show R, G and B: the white of sRGB (x 0.3127, y 0.3290) has as much of each.
TEST_F(WriteExr, HasSrgbForViewers) {
  std::vector<double> white;
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    const double y = kSamples * (1.0 + static_cast<double>(pixel));
    white.insert(white.end(), {y * 0.3127 / 0.3290, y, y * 0.3583 / 0.3290, y * y / kSamples});
  }
  write(white, {});
  const auto image = read();
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    const float y = 1.0f + static_cast<float>(pixel);
    // The matrix has four decimals.
    for (const char* name : {"R", "G", "B"})
      EXPECT_NEAR(image.at(name)[pixel], y, 5e-4f * y) << name;
  }
  const Imf::InputFile file(path_.c_str());
  EXPECT_EQ(Imf::chromaticities(file.header()).red, Imath::V2f(0.64f, 0.33f));
}

TEST_F(WriteExr, AResponseMayBeCalledR) {
  write(sums(5), {"R"});
  const auto image = read();
  EXPECT_EQ(image.size(), 6u);
  expect_means(image.at("R"), 4);
}

TEST_F(WriteExr, RefusesSumsOfOtherChannels) {
  EXPECT_THROW(write(sums(5), {}), std::invalid_argument);
  EXPECT_THROW(write(sums(4), {"rod"}), std::invalid_argument);
}

TEST_F(WriteExr, RefusesANameThatIsTaken) {
  for (const char* taken : {"X", "Y.stderr", "n"}) {
    EXPECT_THROW(write(sums(5), {taken}), std::invalid_argument) << taken;
  }
  EXPECT_THROW(write(sums(6), {"rod", "rod"}), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

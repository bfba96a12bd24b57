#include "image/write_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <vector>

#include "tile/block_samples.h"

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

  void write(const TileSums& film, const std::vector<std::string>& further) const {
    write_exr(path_, film, 32, further, kSamples,
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

// Sums of `kSamples` equal samples: as value `i` pixel p has 10 p + i.
TileSums equal_samples(std::size_t further) {
  TileSums film(kWidth, kHeight, further);
  std::vector<double> values(film.values());
  BlockSamples blocks(film, kSamples);
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = 10.0 * pixel + static_cast<double>(i);
    }
    for (std::uint32_t sample = 0; sample < kSamples; ++sample) {
      add_sample(values.data(), further, &film.sums[film.channels * pixel]);
      blocks.add(pixel % kWidth, pixel / kWidth, sample, values.data());
    }
  }
  blocks.add_to(film);
  return film;
}

void expect_means(const std::vector<float>& values, std::size_t channel) {
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    EXPECT_EQ(values[pixel], static_cast<float>(10 * pixel + channel));
  }
}

// The increase of a sum of squares that increases the mean's variance by so much.
double squares(double variance) { return variance * kSamples * (kSamples - 1); }

// The variance of one more lit sample of the block, whose variances add up to `variance`: over its
// samples weighted by their values, all of which are those of `expect_means`.
double one_more(double variance, std::size_t channel) {
  double found = 0.0, squared = kSamples * (kSamples - 1) * variance;
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    const double value = 10.0 * static_cast<double>(pixel) + static_cast<double>(channel);
    found += kSamples * value;
    squared += kSamples * value * value;
  }
  return variance * squared / (found * found);
}

void expect_errors(const std::vector<float>& errors, double first, std::size_t channel) {
  const double more = one_more(first * first, channel);
  // All samples of the other pixels are finds.
  const double sum = kSamples * static_cast<double>(channel);
  const double squared = sum * sum / kSamples + squares(first * first);
  const double finds = std::max(1.0, sum * sum / squared);
  EXPECT_FLOAT_EQ(errors[0], static_cast<float>(std::sqrt(first * first + more / finds)));
  for (std::size_t pixel = 1; pixel < kPixels; ++pixel) {
    EXPECT_FLOAT_EQ(errors[pixel], static_cast<float>(std::sqrt(more / kSamples)));
  }
}

TEST_F(WriteExr, HoldsMeansErrorsAndCounts) {
  TileSums film = equal_samples(0);
  film.sums[3] += squares(9.0);
  film.sums[4] += squares(16.0);
  film.sums[5] += squares(25.0);
  film.sums[6] += squares(0.5 * 3.0 * 4.0);
  film.sums[7] -= squares(0.25 * 4.0 * 5.0);
  film.sums[8] += squares(3.0 * 5.0);
  write(film, {});
  const auto image = read();
  EXPECT_EQ(image.size(), 25u);
  expect_means(image.at("X"), 0);
  expect_means(image.at("Y"), 1);
  expect_means(image.at("Z"), 2);
  expect_errors(image.at("Y.stderr"), 3.0, 1);
  expect_errors(image.at("X.stderr"), 4.0, 0);
  expect_errors(image.at("Z.stderr"), 5.0, 2);
  EXPECT_FLOAT_EQ(image.at("Y.ownRatio")[0], static_cast<float>(9.0 / (9.0 + one_more(9.0, 1))));
  EXPECT_EQ(image.at("Y.ownRatio")[5], 0.0f);
  EXPECT_FLOAT_EQ(image.at("XY.correlation")[0], 0.5f);
  EXPECT_FLOAT_EQ(image.at("XZ.correlation")[0], -0.25f);
  EXPECT_FLOAT_EQ(image.at("YZ.correlation")[0], 1.0f);
  EXPECT_EQ(image.at("YZ.correlation")[1], 0.0f);
  EXPECT_EQ(image.at("n"), std::vector<float>(kPixels, kSamples));
}

TEST_F(WriteExr, CountsTheSamplesThatAreLitOfStokesParametersAsOfTheirLight) {
  TileSums film = equal_samples(1);
  const std::size_t sum = TileSums::kXyzSums, square = sum + 1;
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {  // as often 2 as -2
    film.sums[film.channels * pixel + sum] = 0.0;
    film.sums[film.channels * pixel + square] = squares(4.0);
  }
  write(film, {"S1.Y"});
  // All samples of Y are finds: 10 p + 1 in pixel p.
  double found = 0.0, squared = 0.0;
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    const double value = 10.0 * static_cast<double>(pixel) + 1.0;
    found += value;
    squared += value * value;
  }
  const double of_block = 4.0 * kPixels / (kSamples * found * found / squared);
  const auto image = read();
  for (const float error : image.at("S1.Y.stderr")) {
    EXPECT_FLOAT_EQ(error, static_cast<float>(std::sqrt(4.0 + of_block / kSamples)));
  }
}

TEST_F(WriteExr, TellsHowErrorsOfNeighboursGoTogether) {
  TileSums film = equal_samples(0);
  EXPECT_EQ(film.block_products.size(), TileSums::kProducts);
  film.sums[3] += squares(9.0);
  film.sums[film.channels + 3] += squares(16.0);
  film.block_products[0] += squares(49.0);  // (3 + 4)^2: wholly correlated
  film.tile_products[0] += squares(98.0);
  film.sums[4] += squares(4.0);
  film.block_products[1] += squares(16.0);
  film.tile_products[1] += squares(8.0);
  film.block_products[3] += squares(0.5 * 7.0 * 4.0);
  write(film, {});
  const auto image = read();
  EXPECT_FLOAT_EQ(image.at("Y.blockRatio")[0], 49.0f / 25.0f);
  EXPECT_EQ(image.at("Y.blockRatio"), std::vector<float>(kPixels, image.at("Y.blockRatio")[0]));
  EXPECT_FLOAT_EQ(image.at("Y.tileRatio")[5], 2.0f);
  EXPECT_FLOAT_EQ(image.at("X.blockRatio")[3], 4.0f);
  EXPECT_FLOAT_EQ(image.at("X.tileRatio")[0], 0.5f);
  EXPECT_EQ(image.at("Z.blockRatio")[0], 1.0f);
  EXPECT_FLOAT_EQ(image.at("XY.blockCorrelation")[4], 0.5f);
  EXPECT_EQ(image.at("XZ.blockCorrelation")[4], 0.0f);
}

TEST_F(WriteExr, HasTwoChannelsForEachFurtherResponse) {
  TileSums film = equal_samples(2);
  film.sums[TileSums::kXyzSums + 3] += squares(4.0);
  write(film, {"rod", "A-far-red"});
  const auto image = read();
  EXPECT_EQ(image.size(), 29u);
  expect_means(image.at("Z"), 2);
  EXPECT_EQ(image.at("Y.stderr"), std::vector<float>(kPixels, 0));
  expect_means(image.at("rod"), 3);
  expect_means(image.at("A-far-red"), 4);
  EXPECT_EQ(image.at("rod.stderr"), std::vector<float>(kPixels, 0));
  expect_errors(image.at("A-far-red.stderr"), 2.0, 4);
}

// Viewers show R, G and B: the white of sRGB (x 0.3127, y 0.3290) has as much of each.
TEST_F(WriteExr, HasSrgbForViewers) {
  TileSums white(kWidth, kHeight, 0);
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    const double y = kSamples * (1.0 + static_cast<double>(pixel));
    double* const sums = &white.sums[white.channels * pixel];
    sums[0] = y * 0.3127 / 0.3290;
    sums[1] = y;
    sums[2] = y * 0.3583 / 0.3290;
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
  write(equal_samples(1), {"R"});
  const auto image = read();
  EXPECT_EQ(image.size(), 24u);
  expect_means(image.at("R"), 3);
}

TEST_F(WriteExr, RefusesSumsOfOtherChannels) {
  EXPECT_THROW(write(equal_samples(1), {}), std::invalid_argument);
  EXPECT_THROW(write(equal_samples(0), {"rod"}), std::invalid_argument);
}

TEST_F(WriteExr, RefusesANameThatIsTaken) {
  for (const char* taken : {"X", "Y.stderr", "XY.correlation", "n"}) {
    EXPECT_THROW(write(equal_samples(1), {taken}), std::invalid_argument) << taken;
  }
  EXPECT_THROW(write(equal_samples(2), {"rod", "rod"}), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

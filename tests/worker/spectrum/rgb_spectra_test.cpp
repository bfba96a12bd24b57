#include "spectrum/rgb_spectra.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace nocturne {
namespace {

const std::vector<float> kScales{0.0f, 0.1f, 0.4f, 1.0f};

// What the sigmoid makes a value of, as far as the table goes.
float argument(float value) {
  const float v = std::clamp(value, 1e-4f, 1.0f - 1e-4f);
  return (v - 0.5f) / std::sqrt(v * (1.0f - v));
}

// Coefficients that are linear in both ratios and the scale's argument, where interpolation is
// exact.
SigmoidSpectrum linear(std::size_t brightest, float scale, float second, float first) {
  const auto b = static_cast<float>(brightest);
  const float z = 0.02f * argument(scale);
  return {1.0f + b + 2.0f * z, 10.0f * b + 3.0f * second, -b + first + z * first};
}

std::vector<SigmoidSpectrum> linear_table() {
  std::vector<SigmoidSpectrum> table;
  for (std::size_t b = 0; b < 3; ++b) {
    for (const float scale : kScales) {
      for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
          table.push_back(
              linear(b, scale, static_cast<float>(y) / 3.0f, static_cast<float>(x) / 3.0f));
        }
      }
    }
  }
  return table;
}

TEST(RgbSpectra, LooksUpByBrightestChannelAndRatios) {
  const RgbSpectra spectra(kScales, linear_table());
  const std::array<float, 3> colours[] = {{0.8f, 0.4f, 0.2f},    {0.1f, 0.7f, 0.35f},
                                          {0.03f, 0.01f, 0.05f}, {1.0f, 1.0f, 0.0f},
                                          {0.0f, 0.0f, 1.0f},    {1.7f, 0.3f, -0.2f}};
  for (auto rgb : colours) {
    const SigmoidSpectrum found = spectra(rgb);
    for (float& c : rgb) c = std::clamp(c, 0.0f, 1.0f);
    const auto b = static_cast<std::size_t>(std::max_element(rgb.begin(), rgb.end()) - rgb.begin());
    const SigmoidSpectrum expected =
        linear(b, rgb[b], rgb[(b + 2) % 3] / rgb[b], rgb[(b + 1) % 3] / rgb[b]);
    EXPECT_NEAR(found.c0, expected.c0, 1e-5f);
    EXPECT_NEAR(found.c1, expected.c1, 1e-4f);
    EXPECT_NEAR(found.c2, expected.c2, 1e-5f);
  }
}

TEST(RgbSpectra, GreysAreExactAtEveryWavelength) {
  const RgbSpectra spectra(kScales, linear_table());
  for (const float grey : {0.0001f, 0.02f, 0.18f, 0.5f, 0.73f, 0.9999f}) {
    EXPECT_NEAR(spectra({grey, grey, grey})(400.0f), grey, 1e-6f);
    EXPECT_NEAR(spectra({grey, grey, grey})(700.0f), grey, 1e-6f);
  }
  EXPECT_NEAR(spectra({0.0f, 0.0f, 0.0f})(500.0f), 1e-4f, 1e-8f);
  EXPECT_NEAR(spectra({2.0f, 2.0f, 2.0f})(500.0f), 1.0f - 1e-4f, 1e-7f);
}

TEST(RgbSpectra, RefusesTablesThatMakeNoSense) {
  EXPECT_THROW(RgbSpectra({0.5f}, {{}, {}, {}}), std::invalid_argument);
  EXPECT_THROW(RgbSpectra({0.0f, 1.0f}, std::vector<SigmoidSpectrum>(23)), std::invalid_argument);
  EXPECT_THROW(RgbSpectra({0.5f, 0.5f}, std::vector<SigmoidSpectrum>(24)), std::invalid_argument);
  EXPECT_THROW(RgbSpectra({0.0f, 1.5f}, std::vector<SigmoidSpectrum>(24)), std::invalid_argument);
  std::vector<SigmoidSpectrum> table(24);
  table[7].c1 = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(RgbSpectra({0.0f, 1.0f}, table), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

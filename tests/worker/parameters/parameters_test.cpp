#include <gtest/gtest.h>

#include <stdexcept>

#include "parameters/colour.h"
#include "parameters/scalar.h"
#include "support/texture_files.h"

namespace nocturne {
namespace {

using test::Picture;

class Parameters : public testing::Test {
 protected:
  // Two rows: 0.2, 0.4 above 0.6, 0.8.
  TextureUse use() {
    return {.texture = Texture(files_.write({2, 2, 1, {0.2f, 0.4f, 0.6f, 0.8f}}), 1,
                               TextureWrap::kRepeat)};
  }
  TextureUse one_colour(float r, float g, float b) {
    return {.texture = Texture(files_.write({1, 1, 3, {r, g, b}}), 3, TextureWrap::kRepeat)};
  }
  // Every entry the same sigmoid.
  static std::shared_ptr<const RgbSpectra> table(SigmoidSpectrum entry) {
    return std::make_shared<const RgbSpectra>(std::vector{0.0f, 1.0f}, std::vector(24, entry));
  }

  static constexpr SurfacePoint kTopLeft{.u = 0.25f, .v = 0.75f};
  static constexpr SurfacePoint kBottomRight{.u = 0.75f, .v = 0.25f};
  test::TextureFiles files_;
};

TEST_F(Parameters, ScalarsLookUpScaledAndShiftedWithGainAndBias) {
  const Scalar plain(use(), 0.0f, 1.0f);
  EXPECT_FLOAT_EQ(plain(kTopLeft), 0.2f);
  EXPECT_FLOAT_EQ(plain(kBottomRight), 0.8f);
  TextureUse other = use();
  other.scale_u = 2.0f;
  other.scale_v = -1.0f;
  other.offset_u = -0.25f;
  other.offset_v = 1.0f;
  other.gain = 0.5f;
  other.bias = 0.125f;
  // (0.25, 0.75) goes to (0.25, 0.25): 0.6.
  EXPECT_FLOAT_EQ(Scalar(other, 0.0f, 1.0f)(kTopLeft), 0.6f * 0.5f + 0.125f);
  EXPECT_FLOAT_EQ(Scalar(other, 0.0f, 0.3f)(kTopLeft), 0.3f);
  other.gain = -1.0f;
  EXPECT_EQ(Scalar(other, 0.0f, 1.0f)(kTopLeft), 0.0f);
  EXPECT_EQ(Scalar(0.7f)(kTopLeft), 0.7f);
}

TEST_F(Parameters, FootprintsScaleWithTheTexture) {
  TextureUse many = use();
  many.scale_u = many.scale_v = 100.0f;
  EXPECT_FLOAT_EQ(Scalar(many, 0.0f, 1.0f)({.u = 0.0025f, .v = 0.0075f, .width = 0.01f}), 0.5f);
}

TEST_F(Parameters, OneChannelMultipliesTheSpectrum) {
  const Spectrum spectrum(500.0f, 100.0f, {0.5f, 1.0f}, false);
  const Colour colour(spectrum, use(), nullptr, 1.0f);
  EXPECT_TRUE(colour.textured());
  EXPECT_FALSE(Colour(spectrum).textured());
  Spectral<4> nm;
  nm.lanes = Spectral<4>::Lanes{500.0f, 550.0f, 600.0f, 650.0f};
  const Spectral<4> found = colour(kTopLeft, nm);
  EXPECT_FLOAT_EQ(found[0], 0.1f);
  EXPECT_FLOAT_EQ(found[1], 0.15f);
  EXPECT_FLOAT_EQ(found[3], 0.2f);
  // Over 360 to 830 nm: 140 nm of 0.5, 100 nm around 0.75, 230 nm of 1.
  EXPECT_FLOAT_EQ(colour.mean(), 0.5f * (140.0f * 0.5f + 100.0f * 0.75f + 230.0f) / 470.0f);
  TextureUse bright = use();
  bright.gain = 10.0f;
  EXPECT_FLOAT_EQ(Colour(Spectrum(0.5f), bright, nullptr, 1.0f)(kTopLeft, nm)[0], 0.5f);
  EXPECT_FLOAT_EQ(Colour(Spectrum(0.5f), bright, nullptr, 1e9f)(kTopLeft, nm)[0], 1.0f);
  bright.gain = -1.0f;
  EXPECT_EQ(Colour(Spectrum(0.5f), bright, nullptr, 1.0f)(kTopLeft, nm)[0], 0.0f);
}

TEST_F(Parameters, ThreeChannelsBecomeASmoothSpectrum) {
  const SigmoidSpectrum entry{-1e-5f, 0.01f, -2.0f};
  const Colour colour(Spectrum(0.5f), one_colour(0.9f, 0.5f, 0.1f), table(entry), 1.0f);
  const Spectral<1> found = colour(kTopLeft, Spectral<1>(620.0f));
  // Weights of the table's entries add up to 1 but for rounding.
  EXPECT_NEAR(found[0], 0.5f * entry(620.0f), 1e-6f);
  EXPECT_GT(colour.mean(), 0.0f);
  const Colour grey(Spectrum(0.5f), one_colour(0.3f, 0.3f, 0.3f), table(entry), 1.0f);
  EXPECT_NEAR(grey(kTopLeft, Spectral<1>(620.0f))[0], 0.15f, 1e-6f);
  EXPECT_NEAR(grey.mean(), 0.15f, 1e-6f);
  EXPECT_THROW(Colour(Spectrum(0.5f), one_colour(1, 0, 0), nullptr, 1.0f), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

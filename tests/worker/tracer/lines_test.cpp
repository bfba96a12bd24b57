// Lamps of narrow lines: radiance is that of their power, whatever their width, with and without a
// density of wavelengths that finds them.
#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_builder.h"
#include "tracer/trace_tile.h"

namespace nocturne {
namespace {

constexpr Film kFilm{8, 8};

std::uint32_t add_lines(test::SceneBuilder& builder, float width, float continuum) {
  const std::uint32_t index = builder.add_spectrum(continuum);
  // Powers add up to 4; two overlap.
  for (const auto& [nm, power] :
       {std::pair{546.074, 1.0}, {546.074 + 0.4 * width, 2.0}, {580.0, 1.0}}) {
    auto& line = *builder.message.mutable_spectra(static_cast<int>(index))->add_lines();
    line.set_centre_nm(nm);
    line.set_power(power);
    line.set_width_nm(width);
  }
  return index;
}

// Half of all wavelengths for lines, as the scene compiler has it; the response is 1 over 500 to
// 600 nm.
void add_density(test::SceneBuilder& builder, double width) {
  auto& sensor = *builder.message.mutable_sensor();
  const double base = 0.5 / 100.0, peak = 0.5 / 4.0 / width;
  const auto add = [&](double nm, double lines) {
    sensor.add_wavelength_knots(nm);
    sensor.add_wavelength_density(static_cast<float>(base + peak * lines));
  };
  add(500, 0);
  add(546.074 - width, 0);
  add(546.074 - 0.6 * width, 0.4);
  add(546.074, 1.0 + 2.0 * 0.6);
  add(546.074 + 0.4 * width, 0.6 + 2.0);
  add(546.074 + width, 2.0 * 0.4);
  add(546.074 + 1.4 * width, 0);
  add(580 - width, 0);
  add(580, 1);
  add(580 + width, 0);
  add(600, 0);
}

struct Image {
  double mean, error;  // of Y over all pixels
};

Image trace(test::SceneBuilder& builder, std::uint32_t group, std::uint32_t samples) {
  builder.message.mutable_tracing()->set_sequence(v1::SAMPLE_SEQUENCE_INDEPENDENT);
  builder.message.mutable_tracing()->set_group(group);
  const TileSums tile =
      trace_tile(*builder.load(), kFilm, {0, 0, kFilm.width, kFilm.height, 0, samples});
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < tile.sums.size(); i += tile.channels) {
    sum += tile.sums[i + 1];
    squares += tile.sums[i + 3];
  }
  EXPECT_EQ(tile.invalid_samples, 0u);
  const double n = static_cast<double>(samples) * kFilm.width * kFilm.height, mean = sum / n;
  return {mean, std::sqrt((squares / n - mean * mean) / (n - 1.0))};
}

// In a furnace of albedo 1/2 radiance is twice the emission: lines of power 4 and a continuum of
// 0.03 over 100 nm give 2 (4 + 3).
test::SceneBuilder furnace(float width, float continuum) {
  test::SceneBuilder builder;
  builder.add_furnace(0.5f, 1.0f);
  const std::uint32_t lines = add_lines(builder, width, continuum);
  for (auto& lamp : *builder.message.mutable_luminaires())
    lamp.mutable_radiance()->set_spectrum(lines);
  return builder;
}

class TracedLines : public testing::TestWithParam<float> {};

// Within 4 standard errors (one false alarm in 16,000 each; seeds are fixed) and the rounding of
// 1e-5.
TEST_P(TracedLines, HaveTheirPower) {
  for (const float continuum : {0.0f, 0.03f}) {
    const double truth = 2.0 * (4.0 + 100.0 * continuum);
    for (const std::uint32_t group : {1u, 4u}) {
      auto builder = furnace(GetParam(), continuum);
      add_density(builder, GetParam());
      const Image image = trace(builder, group, 512);
      EXPECT_NEAR(image.mean, truth, 4.0 * image.error + 1e-5 * truth) << continuum << ' ' << group;
      EXPECT_LT(image.error, 0.02 * truth);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Nanometres, TracedLines, testing::Values(0.01f, 0.1f, 1.0f));

// By the response alone a line is as rare as it is narrow: 0.4 nm of 100 hold all the light.
TEST(TracedLines, AreNoisyWithoutADensity) {
  auto builder = furnace(0.1f, 0.03f);
  const Image blind = trace(builder, 1, 2048);
  add_density(builder, 0.1);
  const Image found = trace(builder, 1, 2048);
  EXPECT_NEAR(blind.mean, 14.0, 4.0 * blind.error);
  EXPECT_NEAR(found.mean, 14.0, 4.0 * found.error);
  EXPECT_GT(blind.error, 5.0 * found.error);
  std::printf("standard error %.4f without, %.4f with the density: ratio %.1f\n", blind.error,
              found.error, blind.error / found.error);
}

// A plane lit by a lamp of lines and, much more weakly, by a flat one: directions go by power, so
// that the lamp of lines gets its photons though its table is zero. The truth is the same lamp with
// a flat spectrum of the same power.
TEST(TracedLines, LampsOfLinesAreAimedAt) {
  const auto scene = [](bool lines) {
    test::SceneBuilder builder;
    builder.add_quad(0.5f, 0.0f, {-50, 0, -50}, {0, 0, 100}, {100, 0, 0});
    builder.add_quad(0.0f, 0.0001f, {-3, 2, -1}, {2, 0, 0}, {0, 0, 2});
    builder.add_quad(0.0f, 0.04f, {1, 2, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f});
    if (lines) {
      const std::uint32_t index = add_lines(builder, 0.01f, 0.0f);
      builder.message.mutable_luminaires(1)->mutable_radiance()->set_spectrum(index);
      add_density(builder, 0.01);
    }
    builder.look({4, 1, 0}, {0, 0, 0}, 1e-3);
    return builder;
  };
  auto flat = scene(false), of_lines = scene(true);
  const Image truth = trace(flat, 1, 4096), image = trace(of_lines, 1, 4096);
  EXPECT_NEAR(image.mean, truth.mean, 4.0 * std::hypot(image.error, truth.error));
  EXPECT_LT(image.error, 3.0 * truth.error);
}

}  // namespace
}  // namespace nocturne

#include "spectrum/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sampling/sequence.h"

namespace nocturne {
namespace {

// By the definition, one line after the other.
double sum_at(const std::vector<Line>& lines, double nm) {
  double sum = 0.0;
  for (const Line& line : lines) {
    sum += line.power / line.width_nm *
           std::max(0.0, 1.0 - std::fabs(nm - line.centre_nm) / line.width_nm);
  }
  return sum;
}

std::vector<Line> many_lines() {
  std::vector<Line> lines;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const auto w = philox4x32({i, 0, 0, 0}, {7, 8});
    lines.push_back({350.0f + 500.0f * to_unit(w[0]), to_unit(w[1]),
                     std::pow(10.0f, -1.0f + 2.5f * to_unit(w[2]))});
  }
  return lines;
}

TEST(Spectrum, LinesOfAllWidthsAddUp) {
  const auto written = many_lines();
  const Lines lines(written);
  for (int i = 0; i < 20'000; ++i) {
    const float nm = 340.0f + 0.026f * static_cast<float>(i);
    const double expected = sum_at(written, nm);
    ASSERT_NEAR(lines(nm), expected, 2e-5 * expected + 1e-5) << nm;
  }
}

TEST(Spectrum, LinesCloserThanTheirWidth) {
  const Spectrum spectrum(Spectrum(1.0f),
                          Lines(std::vector<Line>{{500.25f, 3.0f, 0.5f}, {500.0f, 1.0f, 0.5f}}));
  EXPECT_FLOAT_EQ(spectrum(499.0f), 1.0f);
  EXPECT_FLOAT_EQ(spectrum(499.75f), 1.0f + 1.0f);
  EXPECT_FLOAT_EQ(spectrum(500.0f), 1.0f + 2.0f + 3.0f);
  EXPECT_FLOAT_EQ(spectrum(500.25f), 1.0f + 1.0f + 6.0f);
  EXPECT_FLOAT_EQ(spectrum(500.75f), 1.0f);
}

TEST(Spectrum, AGroupHasTheValuesOfItsPhotons) {
  const Spectrum table(400.0f, 100.0f, {1.0f, 2.0f, 4.0f}, true);
  const Spectrum both(table, Lines(many_lines()));
  Spectral<4> nm;
  for (std::size_t k = 0; k < 4; ++k) nm[k] = 380.0f + 74.0f * static_cast<float>(k);
  const Spectral<4> of_table = table(nm), of_both = both(nm);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(of_table[k], table(nm[k]));
    EXPECT_EQ(of_both[k], both(nm[k]));
  }
}

// However narrow: a lamp of lines is chosen by its power.
TEST(Spectrum, MeansAreExact) {
  EXPECT_DOUBLE_EQ(Spectrum(0.25f).mean_between(400, 500), 0.25);
  const Spectrum line(Spectrum(0.0f), Lines(std::vector<Line>{{546.074f, 470.0f, 0.01f}}));
  EXPECT_NEAR(line.mean(), 1.0, 1e-6);
  EXPECT_NEAR(line.mean_between(500, 546.074f), 0.5 * 470.0 / 46.074, 1e-3);
  EXPECT_EQ(line.mean_between(500, 546.0), 0.0);

  const std::vector<float> values{1.0f, 2.0f, 4.0f};
  const Spectrum held(400.0f, 100.0f, values, false), cut(400.0f, 100.0f, values, true);
  // 150 and 300 between the knots; 40 before at 1, 230 beyond at 4.
  EXPECT_NEAR(held.mean_between(360, 830), (40.0 + 450.0 + 920.0) / 470.0, 1e-6);
  EXPECT_NEAR(cut.mean_between(360, 830), 450.0 / 470.0, 1e-6);
  EXPECT_NEAR(cut.mean_between(450, 550), (0.5 * 1.75 + 0.5 * 2.5), 1e-6);
}

// A germicidal lamp is nothing to a scene of visible light.
TEST(Spectrum, MeansAreOfWhatIsSeen) {
  Spectrum line(Spectrum(0.0f), Lines(std::vector<Line>{{253.65f, 80.0f, 0.01f}}));
  EXPECT_EQ(line.mean(), 0.0f);
  line.set_seen(200.0f, 280.0f);
  EXPECT_NEAR(line.mean(), 1.0, 1e-6);
  Spectrum table(1000.0f, 500.0f, {0.0f, 1.0f}, true);
  table.set_seen(1000.0f, 2000.0f);
  EXPECT_NEAR(table.mean(), 0.25, 1e-6);
}

TEST(Spectrum, RefusesLinesThatMeanNothing) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const Line& line :
       {Line{500.0f, 1.0f, 0.0f}, Line{500.0f, 1.0f, -1.0f}, Line{500.0f, 1.0f, 0.0005f},
        Line{500.0f, -1.0f, 1.0f}, Line{infinity, 1.0f, 1.0f}, Line{500.0f, infinity, 1.0f},
        Line{500.0f, 1.0f, infinity}, Line{500.0f, 1e38f, 0.001f}, Line{500.0f, NAN, 1.0f}}) {
    EXPECT_THROW(Lines(std::vector<Line>{line}), std::invalid_argument);
  }
}

}  // namespace
}  // namespace nocturne

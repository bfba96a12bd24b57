#include "sensors/wavelengths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "spectrum/spectrum.h"
#include "support/chi_square.h"

namespace nocturne {
namespace {

ResponseCurves curves() {
  ResponseCurves c{400.0f, 10.0f, {}, {}, {}, {}};
  for (int i = 0; i <= 30; ++i) {
    const auto bump = [&](double centre) {
      return static_cast<float>(std::exp(-std::pow((10 * i - centre) / 40.0, 2)));
    };
    c.x.push_back(bump(200));
    c.y.push_back(bump(150));
    c.z.push_back(i > 20 ? 0.0f : bump(50));
  }
  return c;
}

double response_at(const std::vector<float>& curve, double nm) {
  const double position = (nm - 400.0) / 10.0;
  const auto cell = std::min(static_cast<std::size_t>(position), curve.size() - 2);
  const double t = position - static_cast<double>(cell);
  return curve[cell] + t * (curve[cell + 1] - curve[cell]);
}

class Wavelengths : public testing::TestWithParam<bool> {};

TEST_P(Wavelengths, SamplesMatchPdf) {
  const WavelengthSampler sampler(curves(), GetParam());
  constexpr int kDraws = 100'000, kCells = 60;
  std::vector<double> observed(kCells), expected(kCells);
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const float u = to_unit(philox4x32({i, 0, 0, 0}, {3, 4})[0]);
    const float nm = sampler.sample<1>(u).nm[0];
    observed[static_cast<std::size_t>(
        std::min(kCells - 1, static_cast<int>((nm - 400.0f) / 5.0f)))] += 1.0;
  }
  double integral = 0.0;
  for (int cell = 0; cell < kCells; ++cell) {
    const double share = 5.0 * sampler.pdf(400.0f + 5.0f * (static_cast<float>(cell) + 0.5f));
    expected[static_cast<std::size_t>(cell)] = share * kDraws;
    integral += share;
  }
  EXPECT_NEAR(integral, 1.0, 1e-5);
  test::expect_same_counts(observed, expected);
}

TEST_P(Wavelengths, MeanWeightIsTheIntegralOfTheResponse) {
  const ResponseCurves c = curves();
  const WavelengthSampler sampler(c, GetParam());
  constexpr int kDraws = 200'000;
  std::array<double, 3> mean{};
  for (int i = 0; i < kDraws; ++i) {
    const auto sample = sampler.sample<1>((static_cast<float>(i) + 0.5f) / kDraws);
    for (std::size_t k = 0; k < 3; ++k) mean[k] += sample.weight[k][0] / kDraws;
  }
  const std::array<const std::vector<float>*, 3> all{&c.x, &c.y, &c.z};
  for (std::size_t k = 0; k < 3; ++k) {
    double integral = 0.0;
    for (std::size_t i = 0; i + 1 < all[k]->size(); ++i)
      integral += 5.0 * ((*all[k])[i] + (*all[k])[i + 1]);
    EXPECT_NEAR(mean[k], integral, 2e-4 * integral);
  }
}

TEST_P(Wavelengths, EndsOfTheUnitIntervalStayOnTheGrid) {
  const WavelengthSampler sampler(curves(), GetParam());
  EXPECT_GE(sampler.sample<1>(0.0f).nm[0], 400.0f);
  EXPECT_LE(sampler.sample<1>(0x1.fffffep-1f).nm[0], 700.0f);
}

// Photons of a group are spread evenly: each has the wavelength of its share of the unit interval.
TEST_P(Wavelengths, GroupsAreStratified) {
  const WavelengthSampler sampler(curves(), GetParam());
  for (const float u : {0.0f, 0.1f, 0.7f, 0.99f}) {
    const auto group = sampler.sample<4>(u);
    for (std::size_t k = 0; k < 4; ++k) {
      const float shifted = u + static_cast<float>(k) / 4.0f;
      const auto one = sampler.sample<1>(shifted < 1.0f ? shifted : shifted - 1.0f);
      EXPECT_EQ(group.nm[k], one.nm[0]);
      EXPECT_EQ(group.weight[1][k], one.weight[1][0]);
    }
  }
}

TEST(WavelengthSampler, FurtherCurvesAreIntegratedToo) {
  ResponseCurves c = curves();
  c.further.push_back(std::vector<float>(c.x.size(), 0.0f));
  c.further[0][29] = 2.0f;  // where X, Y and Z hardly respond: 2 x 10 nm
  const WavelengthSampler sampler(c, true);
  double mean = 0.0;
  constexpr int kDraws = 100'000;
  for (int i = 0; i < kDraws; ++i) {
    const auto sample = sampler.sample<1>((static_cast<float>(i) + 0.5f) / kDraws);
    mean += sampler.further_weight(0, sample)[0] / static_cast<double>(kDraws);
  }
  EXPECT_NEAR(mean, 20.0, 0.02);
}

INSTANTIATE_TEST_SUITE_P(UniformAndResponse, Wavelengths, testing::Bool());

TEST(WavelengthSampler, RefusesCurvesThatMeanNothing) {
  EXPECT_THROW(WavelengthSampler({400, 10, {0, 0}, {0, 0}, {0, 0}, {}}, true),
               std::invalid_argument);
  EXPECT_THROW(WavelengthSampler({400, 10, {1, 1}, {1}, {1, 1}, {}}, true), std::invalid_argument);
}

// Half of all photons in proportion to the response, half to response times the lines; as the scene
// compiler makes it.
DensityTable density_for(const std::vector<Line>& lines) {
  const ResponseCurves c = curves();
  std::vector<float> knots;
  for (std::size_t i = 0; i < c.y.size(); ++i) {
    knots.push_back(400.0f + 10.0f * static_cast<float>(i));
  }
  for (const Line& line : lines) {
    for (const float side : {-1.0f, 0.0f, 1.0f}) {
      knots.push_back(line.centre_nm + side * line.width_nm);
    }
  }
  std::sort(knots.begin(), knots.end());
  const Lines all(lines);
  DensityTable table{knots, {}};
  std::vector<double> response, both;
  const auto area = [&](const std::vector<double>& values) {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      sum += 0.5 * static_cast<double>(knots[i + 1] - knots[i]) * (values[i] + values[i + 1]);
    }
    return sum;
  };
  for (const float nm : knots) {
    response.push_back(response_at(c.x, nm) + response_at(c.y, nm) + response_at(c.z, nm));
    both.push_back(response.back() * all(nm));
  }
  const double whole = area(response), reached = area(both);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    table.values.push_back(static_cast<float>(0.5 * response[i] / whole + 0.5 * both[i] / reached));
  }
  return table;
}

// Sodium's doublet, a line of mercury, and one that overlaps it.
std::vector<Line> narrow_lines(float width = 0.01f) {
  return {{588.995f, 2.0f, width},
          {589.592f, 1.0f, width},
          {546.074f, 1.0f, width},
          {546.074f + 0.3f * width, 1.0f, width}};
}

// Samples are floats: the probability of one is the density there times the distance to the next.
// So the counts of cells as narrow as a twentieth of a line are known exactly.
TEST(WavelengthDensity, SamplesMatchPdfInsideNarrowLines) {
  const auto lines = narrow_lines();
  const WavelengthSampler sampler(curves(), density_for(lines));
  std::vector<float> edges;
  for (int i = 0; i <= 60; ++i) edges.push_back(400.0f + 5.0f * static_cast<float>(i));
  for (const Line& line : lines) {
    for (int i = -20; i <= 20; ++i) {
      edges.push_back(line.centre_nm + 0.05f * static_cast<float>(i) * line.width_nm);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<double> observed(edges.size()), expected(edges.size());
  const auto cell_of = [&](float nm) {
    return static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), nm) -
                                    edges.begin()) -
           1;
  };
  constexpr int kDraws = 1'000'000;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const float u = to_unit(philox4x32({i, 0, 0, 0}, {5, 6})[0]);
    observed[cell_of(sampler.sample<1>(u).nm[0])] += 1.0;
  }
  double integral = 0.0;
  std::size_t cell = 0;
  for (float nm = 400.0f; nm < 700.0f;) {
    const float next = std::nextafter(nm, 1e9f);
    while (cell + 1 < edges.size() && edges[cell + 1] <= nm) ++cell;
    const double share = static_cast<double>(sampler.pdf(nm)) * static_cast<double>(next - nm);
    expected[cell] += share * kDraws;
    integral += share;
    nm = next;
  }
  EXPECT_NEAR(integral, 1.0, 1e-4);
  test::expect_same_counts(observed, expected);
  // Of 300 nm they cover 0.03.
  const double on_lines = std::accumulate(
      observed.begin(), observed.end(), 0.0, [&, i = std::size_t{0}](double sum, double o) mutable {
        const bool narrow = i + 1 < edges.size() && edges[i + 1] - edges[i] < 0.01f;
        ++i;
        return narrow ? sum + o : sum;
      });
  EXPECT_NEAR(on_lines / kDraws, 0.5, 0.01);
}

class LineWidths : public testing::TestWithParam<float> {};

// Where the response is straight, a line's X is its power times the response at its centre, however
// wide it is; each u of a stratified million gives the same.
TEST_P(LineWidths, LinesHaveTheirPowerAndHardlyAnyNoise) {
  const float width = GetParam();
  const ResponseCurves c = curves();
  // All of each within a cell of 10 nm.
  const std::vector<Line> lines{
      {586.995f, 2.0f, width}, {587.592f, 1.0f, width}, {545.2f, 1.0f, width}};
  const Spectrum spectrum(Spectrum(0.0f), Lines(lines));
  const WavelengthSampler found(c, density_for(lines)), blind(c, true);
  std::array<double, 3> truth{};
  for (const Line& line : lines) {
    truth[0] += line.power * response_at(c.x, line.centre_nm);
    truth[1] += line.power * response_at(c.y, line.centre_nm);
    truth[2] += line.power * response_at(c.z, line.centre_nm);
  }
  constexpr int kDraws = 1'000'000;
  std::array<double, 3> mean{};
  double squares = 0.0, blind_squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / kDraws;
    const auto sample = found.sample<1>(u);
    const double value = spectrum(sample.nm[0]);
    for (std::size_t k = 0; k < 3; ++k) mean[k] += sample.weight[k][0] * value / kDraws;
    squares += std::pow(sample.weight[1][0] * value, 2) / kDraws;
    const auto other = blind.sample<1>(u);
    const double y = static_cast<double>(other.weight[1][0]) * spectrum(other.nm[0]);
    blind_squares += y * y / kDraws;
  }
  // The half that knows no lines falls on a line of 0.01 nm a few times only.
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(mean[k], truth[k], 1e-3 * truth[k]) << k;
  const double noise = std::sqrt(squares) / truth[1];
  const double blind_noise = std::sqrt(blind_squares) / truth[1];
  // Half of the photons see nothing: a root mean square of sqrt(2); Y over X + Y + Z differs
  // between lines.
  EXPECT_LT(noise, 1.7);
  EXPECT_GT(blind_noise, 4.0 / std::sqrt(width));
  RecordProperty("noise", std::to_string(std::sqrt(squares / (truth[1] * truth[1]) - 1.0)));
  RecordProperty("noise_without",
                 std::to_string(std::sqrt(blind_squares / (truth[1] * truth[1]) - 1.0)));
  std::printf("width %g nm: relative deviation %.3f with, %.1f without the density\n",
              static_cast<double>(width), std::sqrt(squares / (truth[1] * truth[1]) - 1.0),
              std::sqrt(blind_squares / (truth[1] * truth[1]) - 1.0));
}

INSTANTIATE_TEST_SUITE_P(Nanometres, LineWidths, testing::Values(0.01f, 0.1f, 1.0f));

// One photon of four in each quarter of the density: two of them on the lines, or a neighbour of
// theirs.
TEST(WavelengthDensity, AGroupIsStratified) {
  const auto lines = narrow_lines();
  const Lines all(lines);
  const WavelengthSampler sampler(curves(), density_for(lines));
  for (int i = 0; i < 1000; ++i) {
    const auto samples = sampler.sample<4>((static_cast<float>(i) + 0.5f) / 1000.0f);
    int on_lines = 0;
    for (std::size_t k = 0; k < 4; ++k) on_lines += all(samples.nm[k]) > 0.0f ? 1 : 0;
    ASSERT_GE(on_lines, 1);
    ASSERT_LE(on_lines, 3);
  }
}

TEST(WavelengthSampler, AddsUpValuesOfASample) {
  ResponseCurves c{400, 10, {1, 1, 0}, {1, 1, 0}, {1, 1, 0}, {{1, 1, 1}, {1, 1, 1}}};
  c.counted = {{}, {LightPart::kWhole, 0, true}};
  c.sums = {{{{1, 0.5}, {3, -2.0}}}};
  const WavelengthSampler sampler(c, true);
  EXPECT_EQ(sampler.further_curves(), 2u);
  EXPECT_EQ(sampler.counting_curves(), 1u);
  std::array<double, 5> values{1.0, 4.0, 0.0, 3.0, 0.0};
  sampler.put_sums(values.data());
  EXPECT_EQ(values[4], 0.5 * 4.0 - 2.0 * 3.0);
}

TEST(WavelengthDensity, RefusesWhatWouldLoseLight) {
  const ResponseCurves c{400, 10, {1, 1, 0}, {1, 1, 0}, {1, 1, 0}, {}};
  const auto refuses = [&](std::vector<float> knots, std::vector<float> values) {
    EXPECT_THROW(WavelengthSampler(c, DensityTable{knots, values}), std::invalid_argument);
  };
  EXPECT_NO_THROW(WavelengthSampler(c, DensityTable{{400, 415, 420}, {1, 2, 0}}));
  refuses({}, {});
  refuses({400, 420}, {1});
  refuses({400, 420}, {0, 0});
  refuses({400, 420}, {1, -1});
  refuses({400, 420}, {1, NAN});
  refuses({400, 415, 410, 420}, {1, 1, 1, 1});
  refuses({390, 420}, {1, 1});  // beyond the responses
  refuses({400, 430}, {1, 1});
  refuses({400, 415}, {1, 1});  // ends where there is a response
  refuses({405, 420}, {1, 1});
  refuses({400, 405, 420}, {1, 0, 1});  // zero in between
}

}  // namespace
}  // namespace nocturne

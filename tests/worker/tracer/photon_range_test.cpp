// Forward photons, alone and with adjoint ones, in ranges of the whole film.
#include <gtest/gtest.h>

#include <cmath>

#include "math/constants.h"
#include "support/caustic_scene.h"
#include "tracer/trace_film.h"
#include "tracer/trace_photon_range.h"

namespace nocturne {
namespace {

constexpr Film kFilm{64, 48};
constexpr std::uint32_t kTile = 16;
constexpr std::uint32_t kPixels = kFilm.width * kFilm.height;

std::shared_ptr<const Scene> caustic(std::uint64_t seed = 0) {
  auto builder = test::floor_and_lamp(true);
  builder.message.mutable_tracing()->set_seed(seed);
  return builder.load();
}

TileSums film_of(const Scene& scene, unsigned threads, const std::vector<std::uint32_t>& samples,
                 const std::vector<std::uint32_t>& bundles) {
  return trace_film(scene, {kFilm, kTile, samples, bundles}, threads, [](double) {}).first;
}

/// Mean Y of the pixels of a tile together, and its variance if pixels know nothing of each other.
struct MeanY {
  double mean = 0.0, variance = 0.0;
};

MeanY mean_y(const TileSums& film, std::uint32_t tile, double samples) {
  MeanY found;
  for (std::uint32_t i = 0; i < kTile * kTile; ++i) {
    const std::uint32_t x = tile % 4 * kTile + i % kTile, y = tile / 4 * kTile + i / kTile;
    const double* pixel = &film.sums[film.channels * (std::size_t{y} * film.width + x)];
    found.mean += pixel[1] / samples;
    found.variance += (pixel[3] - pixel[1] * pixel[1] / samples) / (samples * (samples - 1.0));
  }
  return found;
}

TEST(PhotonRanges, NumberOfThreadsDoesNotMatter) {
  const auto scene = caustic();
  const TileSums one = film_of(*scene, 1, {4, 8}, {1, 2});
  for (const unsigned threads : {2u, 8u}) {
    const TileSums more = film_of(*scene, threads, {4, 8}, {1, 2});
    EXPECT_EQ(one.sums, more.sums);
    EXPECT_EQ(one.block_products, more.block_products);
    EXPECT_EQ(one.tile_products, more.tile_products);
  }
  EXPECT_EQ(one.photons, 8 * kPixels + 2 * kPhotonBundle);
}

TEST(PhotonRanges, GoAlongWithRangesOfTilesWhereSomebodyIsAsked) {
  const auto scene = caustic();
  const std::vector<std::uint32_t> samples{4, 8}, bundles{1, 2};
  const auto [whole, end] = trace_film_by_ranges(
      *scene, {kFilm, kTile, samples, bundles}, 2, [](double) {},
      [&](std::uint32_t asked, const TileSums& film) {
        EXPECT_EQ(asked, 4u);
        EXPECT_EQ(film.photons, 4 * kPixels + kPhotonBundle);
        return true;
      });
  EXPECT_EQ(end, 8u);
  EXPECT_EQ(whole.sums, film_of(*scene, 1, samples, bundles).sums);
}

// Differences of two images by other numbers, over their errors, vary as much as errors say. Bounds
// hold 0.9998 of a chi-square of 24 tiles.
TEST(PhotonRanges, HaveErrorsThatCover) {
  constexpr std::uint32_t kSamples = 32;
  double z_squared = 0.0;
  for (const std::uint64_t seed : {1u, 2u}) {
    const TileSums few = film_of(*caustic(seed), 2, {kSamples}, {16});
    const TileSums many = film_of(*caustic(seed + 100), 2, {4 * kSamples}, {16, 64});
    for (std::uint32_t tile = 0; tile < 12; ++tile) {
      const MeanY a = mean_y(few, tile, kSamples), b = mean_y(many, tile, 4 * kSamples);
      z_squared += std::pow(a.mean - b.mean, 2) / (a.variance + b.variance);
    }
  }
  EXPECT_GT(z_squared, 7.0);
  EXPECT_LT(z_squared, 57.0);
}

// A ball of radius r and radiance L has the intensity L pi r^2 in every direction; Y integrates
// over 100 nm. Pixels of a film of 4 x 2 have the same solid angle, so a photon is in each with
// p = 1/8, and n of them give it the relative error sqrt((1 - p) / (p n)).
TEST(PhotonRanges, AreAllOfAFilmOfForwardPhotonsAlone) {
  constexpr Film kDirections{4, 2};
  test::SceneBuilder builder;
  builder.add_sphere(0.0f, 3.0f, {0, 0, 0}, 0.5);
  auto& sensor = *builder.message.mutable_sensor();
  sensor.set_model(v1::SENSOR_MODEL_INTENSITY);
  sensor.set_lamp_radius(1.0);
  builder.message.mutable_tracing()->set_direction(v1::DIRECTION_FORWARD);
  const auto scene = builder.load();
  const std::vector<std::uint32_t> bundles{1, 2, 4};
  const FilmPlan plan{kDirections, kTile, {}, bundles};
  const auto [film, samples] = trace_film(*scene, plan, 2, [](double) {});
  EXPECT_EQ(samples, 4 * kPhotonBundle / 8);
  EXPECT_EQ(samples, plan.samples());
  EXPECT_EQ(film.photons, 4 * kPhotonBundle);
  const double expected = 100.0 * 3.0 * 0.25 * static_cast<double>(kPi);
  const double error = expected * std::sqrt(7.0 / (4.0 * kPhotonBundle));
  for (std::size_t pixel = 0; pixel < 8; ++pixel) {
    const double y = film.sums[pixel * film.channels + 1], n = samples;
    const double squares = film.sums[pixel * film.channels + 3];
    EXPECT_NEAR(y / n, expected, 4.0 * error);
    EXPECT_NEAR(std::sqrt((squares - y * y / n) / (n * (n - 1.0))), error, 0.03 * error);
  }
  std::vector<std::uint32_t> asked;
  const auto [by_ranges, all] = trace_film_by_ranges(
      *scene, plan, 1, [](double) {},
      [&](std::uint32_t so_far, const TileSums&) {
        asked.push_back(so_far);
        return true;
      });
  EXPECT_EQ(asked, (std::vector<std::uint32_t>{kPhotonBundle / 8, 2 * kPhotonBundle / 8}));
  EXPECT_EQ(all, samples);
  EXPECT_EQ(by_ranges.sums, film.sums);
  EXPECT_THROW(trace_tile(*scene, kDirections, {0, 0, 4, 2, 0, 1}), std::invalid_argument);
}

TEST(PhotonRanges, VariancesOfBothPartsAddUp) {
  TileSums film(4, 4, 1), photons(4, 4, 1);
  const double pixels = 16.0, bundles = 2.0, count = bundles * kPhotonBundle, samples = 8.0;
  for (std::size_t i = 0; i < film.sums.size(); ++i) {
    film.sums[i] = 1.0 + static_cast<double>(i % film.channels);
    photons.sums[i] = 3.0;
  }
  const TileSums alone = film;
  add_photons(photons, 2, 8, 4, film);
  const double scale = samples * pixels / count;
  EXPECT_DOUBLE_EQ(film.sums[1] / samples, alone.sums[1] / samples + 3.0 * pixels / count);
  const auto variance = [](double square, double sum, double n) {
    return (square - sum * sum / n) / (n * (n - 1.0));
  };
  const double of_photons = (3.0 - 9.0 / count) * (scale / samples) * (scale / samples);
  EXPECT_NEAR(variance(film.sums[3], film.sums[1], samples),
              variance(alone.sums[3], alone.sums[1], samples) + of_photons, 1e-12);
  // The further response and its square.
  EXPECT_NEAR(variance(film.sums[10], film.sums[9], samples),
              variance(alone.sums[10], alone.sums[9], samples) + of_photons, 1e-12);
}

TEST(PhotonRanges, AreRoundedToWhatIsSent) {
  TileSums sums(1, 1, 0);
  sums.sums[0] = 1.0 + 1e-9;
  sums.sums[3] = 1.0 + 1.0 / 256.0;  // half a step of eight bits: up
  sums.sums[4] = 1.0 + 1.0 / 512.0;
  round_photon_sums(sums);
  EXPECT_EQ(sums.sums[0], 1.0);
  EXPECT_EQ(sums.sums[3], 1.0 + 1.0 / 128.0);
  EXPECT_EQ(sums.sums[4], 1.0);
}

TEST(PhotonRanges, AreRefusedForScenesOfAdjointPhotonsAlone) {
  const auto scene = test::floor_and_lamp(false).load();
  EXPECT_THROW(trace_photon_range(*scene, kFilm, kTile, {0, 1}), std::invalid_argument);
}

TEST(PhotonRanges, FailTogetherWithTheirFilm) {
  const auto scene = test::floor_and_lamp(false).load();
  EXPECT_THROW(film_of(*scene, 3, {4}, {1, 2, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

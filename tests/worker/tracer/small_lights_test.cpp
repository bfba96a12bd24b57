// Luminaires that fill a small part of a pixel: samples are drawn as their weights say, pixels have
// the value on paper, and few samples know it well.
#include "tracer/small_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sampling/philox.h"
#include "sampling/sequence.h"
#include "support/chi_square.h"
#include "support/estimates.h"
#include "support/scene_builder.h"
#include "tracer/trace_tile.h"

namespace nocturne {
namespace {

using test::estimate;
using test::kResponseIntegral;

constexpr Film kPanorama{32, 16};
constexpr double kPixel = 2.0 * std::numbers::pi / kPanorama.width;  // radians

/// Over a small black ball, as a scene needs a surface.
void set_panorama(test::SceneBuilder& builder) {
  builder.add_sphere(0.0f, 0.0f, {0, -10, 0}, 0.1);
  builder.message.mutable_sensor()->set_model(v1::SENSOR_MODEL_PANORAMA);
}

/// A disc in front, `right` and `up` pixels from the middle of the panorama, which is a corner of
/// pixels.
void add_disc(test::SceneBuilder& builder, double half_angle, double right, double up) {
  const double azimuth = right * kPixel, altitude = up * kPixel;
  auto& disc = *builder.message.add_distant_discs();
  test::SceneBuilder::set(*disc.mutable_direction(),
                          {static_cast<float>(std::cos(altitude) * std::sin(azimuth)),
                           static_cast<float>(std::sin(altitude)),
                           static_cast<float>(-std::cos(altitude) * std::cos(azimuth))});
  disc.set_half_angle(half_angle);
  disc.set_radiance(builder.add_spectrum(1e6f));
}

TileSums trace(const test::SceneBuilder& builder, Film film, std::uint32_t samples) {
  return trace_tile(*builder.load(), film, {0, 0, film.width, film.height, 0, samples});
}

// Counts of points in cells of the pixel, against the density that the weights tell.
TEST(SmallLights, PointsAreDrawnAsTheirWeightsSay) {
  test::SceneBuilder builder;
  set_panorama(builder);
  add_disc(builder, 0.2 * kPixel, 0.6, 0.45);
  const SmallLights lights(*builder.load(), kPanorama);
  ASSERT_EQ(lights.pixels(), 1u);
  const std::uint32_t pixel = 7 * kPanorama.width + 16;

  constexpr std::uint32_t kCells = 16, kSteps = 32, kDraws = 100000;
  std::vector<double> observed(kCells * kCells), expected(kCells * kCells);
  PixelSequence numbers(SequenceKind::kIndependent, 3, 0);
  double weights = 0.0;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const Uniform4 u = PhotonSequence(numbers, i).next();
    float x = u[0], y = u[1];
    weights += static_cast<double>(lights.move(pixel, x, y)) / kDraws;
    const auto column = std::min(kCells - 1, static_cast<std::uint32_t>(x * kCells));
    const auto row = std::min(kCells - 1, static_cast<std::uint32_t>(y * kCells));
    observed[row * kCells + column] += 1.0;
  }
  // Points beyond the first quarter of x fill the pixel evenly: each has the weight of where it is.
  for (std::uint32_t row = 0; row < kCells * kSteps; ++row) {
    for (std::uint32_t column = 0; column < kCells * kSteps; ++column) {
      float x = 0.25f + 0.75f * (static_cast<float>(column) + 0.5f) / (kCells * kSteps);
      float y = (static_cast<float>(row) + 0.5f) / (kCells * kSteps);
      expected[row / kSteps * kCells + column / kSteps] +=
          static_cast<double>(kDraws) / (kCells * kCells * kSteps * kSteps) /
          static_cast<double>(lights.move(pixel, x, y));
    }
  }
  test::expect_same_counts(observed, expected);
  // The variance of a weight is below 1 / 0.75 - 1.
  EXPECT_NEAR(weights, 1.0, 4.0 * std::sqrt(0.34 / kDraws));
}

// The Sun over a pixel: radiance x its part of the pixel's solid angle. Of 256 samples spread
// evenly a pixel would have half a hit, and an error of more than its value.
TEST(SmallLights, TheSunInAPixel) {
  const double half_angle = 0.00465;
  const double sun = 2.0 * std::numbers::pi * (1.0 - std::cos(half_angle));
  test::SceneBuilder builder;
  set_panorama(builder);
  add_disc(builder, half_angle, 0.3, 0.6);
  const TileSums tile = trace(builder, kPanorama, 256);
  const double pixel = kPixel * std::sin(kPixel);  // next to the horizon
  const auto seen = estimate(tile, 7 * kPanorama.width + 16, 256);
  const double truth = kResponseIntegral * 1e6 * sun / pixel;
  EXPECT_NEAR(seen.y, truth, 4.0 * seen.standard_error);
  EXPECT_LT(seen.standard_error, 0.2 * truth);
}

// On an edge between pixels, and on a corner: each has its part.
TEST(SmallLights, TheSunInSeveralPixels) {
  const double half_angle = 0.00465;
  const double sun = 2.0 * std::numbers::pi * (1.0 - std::cos(half_angle));
  const double whole = kResponseIntegral * 1e6 * sun / (kPixel * std::sin(kPixel));
  for (const double up : {0.5, 0.0}) {
    test::SceneBuilder builder;
    set_panorama(builder);
    add_disc(builder, half_angle, 0.0, up);
    const TileSums tile = trace(builder, kPanorama, 1024);
    const double part = up == 0.0 ? 0.25 : 0.5;
    for (const std::uint32_t column : {15u, 16u}) {
      const auto seen = estimate(tile, 7 * kPanorama.width + column, 1024);
      EXPECT_NEAR(seen.y, part * whole, 4.0 * seen.standard_error) << up << " " << column;
      EXPECT_LT(seen.standard_error, 0.2 * part * whole);
    }
  }
}

// A spherical lamp of radius r, d away on the axis of a pinhole camera, fills pi tan^2(asin(r/d))
// of the film at distance 1.
TEST(SmallLights, ALampFarAway) {
  constexpr double kRadius = 0.01, kDistance = 30.0;
  test::SceneBuilder builder;
  builder.look({0, 0, 0}, {0, 0, -1}, 0.9);
  builder.add_sphere(0.0f, 1e6f, {0, 0, static_cast<float>(-kDistance)}, kRadius);
  const TileSums tile = trace(builder, {15, 15}, 256);
  const double tangent = std::tan(std::asin(kRadius / kDistance));
  const double edge = 2.0 * std::tan(0.45) / 15.0;
  const double truth =
      kResponseIntegral * 1e6 * std::numbers::pi * tangent * tangent / (edge * edge);
  const auto seen = estimate(tile, 7 * 15 + 7, 256);
  EXPECT_NEAR(seen.y, truth, 4.0 * seen.standard_error);
  EXPECT_LT(seen.standard_error, 0.2 * truth);
}

// What hides the lamp is as bright as it was.
TEST(SmallLights, ALampBehindAWall) {
  test::SceneBuilder builder;
  builder.look({0, 0, 0}, {0, 0, -1}, 0.9);
  builder.add_quad(0.0f, 2.0f, {-50, -50, -2}, {100, 0, 0}, {0, 100, 0});
  builder.add_sphere(0.0f, 1e6f, {0, 0, -30}, 0.01);
  ASSERT_EQ(SmallLights(*builder.load(), {15, 15}).pixels(), 1u);
  const auto seen = estimate(trace(builder, {15, 15}, 256), 7 * 15 + 7, 256);
  EXPECT_NEAR(seen.y, kResponseIntegral * 2.0, 4.0 * seen.standard_error);
}

// A furnace with a small ball in it that emits and reflects like its walls has the same radiance at
// every pixel, by samples of different weights, shared by neighbours or not.
TEST(SmallLights, AFurnaceWithASmallLamp) {
  for (const std::uint32_t sharing : {1u, 16u}) {
    test::SceneBuilder builder;
    builder.look({0, 0, 0}, {0, 0, -1}, 0.9);
    builder.add_furnace(0.5f, 2.0f);
    builder.add_sphere(0.5f, 2.0f, {0.03f, 0.02f, -0.9f}, 0.002);
    builder.message.mutable_tracing()->set_sharing(sharing);
    ASSERT_EQ(SmallLights(*builder.load(), {8, 8}).pixels(), 1u);
    SCOPED_TRACE(sharing);
    test::expect_all_pixels(trace(builder, {8, 8}, 1024), 1024, kResponseIntegral * 4.0);
  }
}

// Samples stay where they were: at lamps larger than a pixel, hidden from the camera, or across the
// seam of a panorama, and for a camera that moves or has a lens.
TEST(SmallLights, OthersAreNotLookedFor) {
  const auto pixels = [](const auto& change) {
    test::SceneBuilder builder;
    builder.look({0, 0, 0}, {0, 0, -1}, 0.9);
    builder.add_sphere(0.0f, 1e6f, {0, 0, -30}, 0.01);
    change(builder);
    return SmallLights(*builder.load(), {15, 15}).pixels();
  };
  EXPECT_EQ(pixels([](test::SceneBuilder&) {}), 1u);
  EXPECT_EQ(pixels([](auto& b) { b.message.mutable_surfaces(0)->mutable_sphere()->set_radius(3); }),
            0u);
  EXPECT_EQ(pixels([](auto& b) {
              b.message.mutable_luminaires(0)->set_hidden_from(v1::HIDDEN_FROM_CAMERA);
            }),
            0u);
  EXPECT_EQ(pixels([](auto& b) {
              b.message.mutable_sensor()->set_lens_radius(0.01);
              b.message.mutable_sensor()->set_focus_distance(3);
            }),
            0u);
  EXPECT_EQ(pixels([](auto& b) {
              auto& pose = *b.message.mutable_sensor()->add_later_poses();
              *pose.mutable_position() = b.message.sensor().position();
              *pose.mutable_right() = b.message.sensor().right();
              *pose.mutable_up() = b.message.sensor().up();
              *pose.mutable_forward() = b.message.sensor().forward();
              pose.mutable_position()->set_x(0.1);
            }),
            0u);
  test::SceneBuilder builder;
  set_panorama(builder);
  add_disc(builder, 0.00465, 16.0, 0.5);
  EXPECT_EQ(SmallLights(*builder.load(), kPanorama).pixels(), 0u);
}

}  // namespace
}  // namespace nocturne

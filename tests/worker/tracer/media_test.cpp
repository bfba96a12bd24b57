// Media with an answer on paper: white furnaces, attenuation, slabs, and one medium cut in two.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "baselines/trace_tile.h"
#include "digest/sha256.h"
#include "media/grid_bytes.h"
#include "support/effort.h"
#include "support/estimates.h"
#include "support/scene_builder.h"
#include "tracer/trace_tile.h"

namespace nocturne {
namespace {

using test::expect_all_pixels;
using test::kResponseIntegral;

struct Variant {
  const char* name;
  v1::Estimator estimator;
  std::uint32_t group;
};

class Media : public testing::TestWithParam<Variant> {
 protected:
  TileSums trace(test::SceneBuilder& builder, std::uint32_t samples) const {
    auto& tracing = *builder.message.mutable_tracing();
    tracing.set_estimator(GetParam().estimator);
    tracing.set_split_vertices(2);
    tracing.set_group(GetParam().group);
    tracing.set_maximum_depth(0);
    const std::uint32_t edge = test::film_edge(16);
    return trace_tile(*builder.load(), {edge, edge}, {0, 0, edge, edge, 0, samples});
  }

  // Around everything; its radiance comes from all sides.
  static void add_sky(test::SceneBuilder& builder, float radiance) {
    builder.message.mutable_environment()->set_constant(builder.add_spectrum(radiance));
  }
};

// Whatever a medium does to photons without absorbing any, uniform light stays uniform. The
// spectra differ over the response, so that photons of a group part company with their path pdf
// ratios.
TEST_P(Media, WhiteFurnace) {
  for (const double g : {-0.5, 0.0, 0.9}) {
    test::SceneBuilder builder;
    builder.look({0, 0, 4}, {0, 0, 0}, 0.6);
    add_sky(builder, 3.0f);
    const auto medium =
        builder.add_medium(builder.add_spectrum(0.0f), builder.add_ramp(0.5f, 4.0f), g);
    if (g == 0.0) builder.set_scale_height(medium, {0, -1, 0}, 0.5);
    builder.add_matched_sphere({0.1f, 0, 0}, 1.0, {medium});
    SCOPED_TRACE(g);
    expect_all_pixels(trace(builder, 128), 128, kResponseIntegral * 3.0);
  }
}

// The sensor inside, two media overlapping, one of them unbounded in front of walls that emit.
TEST_P(Media, FurnaceFromInside) {
  test::SceneBuilder builder;
  builder.add_furnace(0.5f, 2.0f);
  const auto grey = builder.add_medium(builder.add_spectrum(0.0f), builder.add_spectrum(0.7f), 0.3);
  const auto coloured =
      builder.add_medium(builder.add_spectrum(0.0f), builder.add_ramp(2.0f, 0.2f), 0.0);
  builder.add_unbounded({grey});
  builder.add_matched_sphere({0, 0, 0}, 0.8, {coloured});
  expect_all_pixels(trace(builder, 256), 256, kResponseIntegral * 2.0 / 0.5);
}

// Radiance behind an absorbing slab of thickness d falls by exp(-a d), integrated over the
// response: a ramp from a to b over 100 nm gives (exp(-a d) - exp(-b d)) / ((b - a) d).
TEST_P(Media, AbsorbingSlab) {
  test::SceneBuilder builder;
  builder.look({0, 0, 4}, {0, 0, 0}, 1e-3);
  add_sky(builder, 5.0f);
  const auto medium =
      builder.add_medium(builder.add_ramp(0.5f, 2.0f), builder.add_spectrum(0.0f), 0.0);
  builder.add_matched_box({-9, -9, -0.4f}, {9, 9, 0.4f}, {medium});
  const double d = 0.8, a = 0.5, b = 2.0;
  expect_all_pixels(
      trace(builder, 256), 256,
      kResponseIntegral * 5.0 * (std::exp(-a * d) - std::exp(-b * d)) / ((b - a) * d));
}

// A density that varies is met by chance under bounds. The same slab absorbs as much wherever its
// density sits: here it falls as exp(-z / 0.3 m), integral 0.3 (1 - exp(-0.8 / 0.3)) m.
TEST_P(Media, AbsorbingAltitude) {
  test::SceneBuilder builder;
  builder.look({0, 0, 4}, {0, 0, 0}, 1e-3);
  add_sky(builder, 5.0f);
  const auto medium =
      builder.add_medium(builder.add_ramp(1.0f, 4.0f), builder.add_spectrum(0.0f), 0.0);
  builder.set_scale_height(medium, {0, 0, -0.4f}, 0.3);
  builder.add_matched_box({-9, -9, -0.4f}, {9, 9, 0.4f}, {medium});
  const double d = 0.3 * (1.0 - std::exp(-0.8 / 0.3)), a = 1.0, b = 4.0;
  expect_all_pixels(
      trace(builder, 256), 256,
      kResponseIntegral * 5.0 * (std::exp(-a * d) - std::exp(-b * d)) / ((b - a) * d));
}

// Light that a slab of albedo 0.9, Henyey-Greenstein g = 0.75 and optical thickness 2 lets pass, at
// normal incidence: total transmittance 0.66096 (van de Hulst, Multiple Light Scattering, 1980, as
// in Prahl et al.'s MCML manual); by reciprocity radiance seen along the normal through the slab
// before a uniformly bright half space. Only the optical thickness matters, not where it sits. The
// slab is 200 thicknesses wide.
TEST_P(Media, VanDeHulstSlab) {
  for (const bool even : {true, false}) {
    test::SceneBuilder builder;
    builder.look({0, 0, 2}, {0, 0, 0}, 1e-3);
    builder.add_quad(0.0f, 1.0f, {-400, -400, -1.0f}, {800, 0, 0}, {0, 800, 0});
    const double height = 0.25, share = height * (1.0 - std::exp(-1.0 / height));
    const auto thick = static_cast<float>(even ? 2.0 : 2.0 / share);
    const auto medium = builder.add_medium(builder.add_spectrum(0.1f * thick),
                                           builder.add_spectrum(0.9f * thick), 0.75);
    if (!even) builder.set_scale_height(medium, {0, 0, -0.5f}, height);
    builder.add_matched_box({-100, -100, -0.5f}, {100, 100, 0.5f}, {medium});
    SCOPED_TRACE(even);
    expect_all_pixels(trace(builder, 256), 256, kResponseIntegral * 0.6609577);
  }
}

// Two media, one of them denser below, or five in the same place that add up to them, by two seeds:
// equal images. The mean of 256 pixels within 4.5 standard errors (one false alarm in 150,000).
TEST_P(Media, OverlappingMediaAddUp) {
  const auto scene = [&](bool merged) {
    test::SceneBuilder builder;
    builder.look({0, 0, 4}, {0, 0, 0}, 0.6);
    builder.add_sphere(0.0f, 20.0f, {0, 3, 0}, 0.5);
    std::vector<std::uint32_t> media;
    if (merged) {
      media = {builder.add_medium(builder.add_spectrum(0.3f), builder.add_ramp(0.7f, 2.3f), 0.4),
               builder.add_medium(builder.add_spectrum(0.5f), builder.add_ramp(2.0f, 0.5f), 0.4)};
      builder.set_scale_height(media[1], {0, -1, 0}, 0.4);
    } else {
      media = {builder.add_medium(builder.add_spectrum(0.1f), builder.add_spectrum(0.2f), 0.4),
               builder.add_medium(builder.add_spectrum(0.3f), builder.add_ramp(0.0f, 0.3f), 0.4),
               builder.add_medium(builder.add_spectrum(0.2f), builder.add_ramp(0.1f, 1.7f), 0.4),
               builder.add_medium(builder.add_spectrum(0.0f), builder.add_spectrum(0.4f), 0.4),
               builder.add_medium(builder.add_spectrum(0.2f), builder.add_ramp(2.0f, 0.2f), 0.4)};
      builder.set_scale_height(media[1], {0, -1, 0}, 0.4);
      builder.set_scale_height(media[4], {0, -1, 0}, 0.4);
      builder.message.mutable_tracing()->set_seed(1);
    }
    builder.add_matched_sphere({0, 0, 0}, 1.0, media);
    return trace(builder, 256);
  };
  const auto a = test::estimate_mean(scene(true), 256), b = test::estimate_mean(scene(false), 256);
  EXPECT_GT(a.y, 0.0);
  EXPECT_NEAR(a.y, b.y, 4.5 * std::hypot(a.standard_error, b.standard_error));
}

INSTANTIATE_TEST_SUITE_P(All, Media,
                         testing::Values(Variant{"Mixture", v1::ESTIMATOR_MIXTURE, 1},
                                         Variant{"Split", v1::ESTIMATOR_SPLIT, 4},
                                         Variant{"TwoPhotons", v1::ESTIMATOR_TWO_PHOTONS, 1},
                                         Variant{"TwoPhotonsOfFour", v1::ESTIMATOR_TWO_PHOTONS, 4}),
                         [](const auto& variant) { return variant.param.name; });

// Light that is scattered once, found by chance and by marching: a lamp next to a ball of medium
// that is denser below. 150 steps leave an error of less than a thousandth, and both means are
// known to a standard error each (4.5 of both: one false alarm in 150,000).
TEST(RayMarching, AgreesOnSingleScattering) {
  test::SceneBuilder builder;
  builder.look({0, 0, 4}, {0, 0, 0}, 0.6);
  builder.add_sphere(0.0f, 20.0f, {0, 2.5f, 0}, 0.5);
  const auto medium =
      builder.add_medium(builder.add_spectrum(0.2f), builder.add_spectrum(0.9f), 0.5);
  builder.set_scale_height(medium, {0, -1, 0}, 0.8);
  builder.add_matched_sphere({0, 0, 0}, 1.0, {medium});
  builder.message.mutable_tracing()->set_estimator(v1::ESTIMATOR_TWO_PHOTONS);
  builder.message.mutable_tracing()->set_maximum_depth(1);
  const auto scene = builder.load();
  const TileRange range{0, 0, 16, 16, 0, 256}, few{0, 0, 16, 16, 0, 4};
  const auto by_chance = test::estimate_mean(trace_tile(*scene, {16, 16}, range), 256);
  const auto marched =
      test::estimate_mean(baselines::trace_tile_by_marching(*scene, {16, 16}, few, 150), 4);
  EXPECT_GT(marched.y, 0.0);
  EXPECT_NEAR(
      by_chance.y, marched.y,
      4.5 * std::hypot(by_chance.standard_error, marched.standard_error) + 1e-3 * marched.y);
}

// Grids of voxels, from z = low to high of the slab [-0.5, 0.5] in steps of a tenth of a metre.
class GridMedia : public testing::Test {
 protected:
  // A hundred metres wide, of one value in each layer.
  static void set_grid(test::SceneBuilder& builder, v1::DensityGrid& grid, const char* name,
                       const std::function<float(int z)>& value) {
    const auto bytes =
        test::grid_bytes([&](int, int, int z) { return value(z); }, {-8, -8, 0}, {7, 7, 9});
    const auto file = std::filesystem::path(testing::TempDir()) / (std::string("media_") + name);
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    const std::string blob(32, name[0]);
    grid.set_blob(blob);
    builder.files[to_hex(blob)] = file;
    // Voxel z holds the layer from -0.5 + z / 10 to a tenth above.
    for (const double number : {10.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.1, -0.45}) {
      grid.add_transform(number);
    }
    grid.set_scale(1.0);
    grid.set_nearest(true);
  }

  static TileSums trace(test::SceneBuilder& builder) {
    builder.look({0, 0, 4}, {0, 0, 0}, 1e-3);
    builder.add_matched_box({-50, -50, -0.5f}, {50, 50, 0.5f}, {0});
    auto& tracing = *builder.message.mutable_tracing();
    tracing.set_estimator(v1::ESTIMATOR_TWO_PHOTONS);
    tracing.set_group(4);
    tracing.set_maximum_depth(0);
    return trace_tile(*builder.load(), {16, 16}, {0, 0, 16, 16, 0, 256});
  }
};

// As VanDeHulstSlab, with the scatterers in layers of any density, some of them empty.
TEST_F(GridMedia, SlabInLayers) {
  const std::array<float, 10> layers{0, 3, 0.5f, 0, 7, 0, 0, 1, 2.5f, 6};  // sum 20, a tenth each
  test::SceneBuilder builder;
  builder.add_quad(0.0f, 1.0f, {-400, -400, -1.0f}, {800, 0, 0}, {0, 800, 0});
  const auto medium =
      builder.add_medium(builder.add_spectrum(0.1f), builder.add_spectrum(0.9f), 0.75);
  set_grid(builder, *builder.message.mutable_media(static_cast<int>(medium))->mutable_grid(),
           "slab", [&](int z) { return layers[static_cast<std::size_t>(z)]; });
  expect_all_pixels(trace(builder), 256, kResponseIntegral * 0.6609577);
}

// As AbsorbingSlab, where voxels are as dense as their bounds: of the photon with the largest
// extinction nothing is left at a tentative collision, and not less by rounding.
TEST_F(GridMedia, AbsorbingSlabAsDenseAsItsBounds) {
  test::SceneBuilder builder;
  builder.message.mutable_environment()->set_constant(builder.add_spectrum(5.0f));
  const auto medium =
      builder.add_medium(builder.add_ramp(0.5f, 2.0f), builder.add_spectrum(0.0f), 0.0);
  set_grid(builder, *builder.message.mutable_media(static_cast<int>(medium))->mutable_grid(),
           "bounds", [](int) { return 0.7f; });
  const TileSums tile = trace(builder);
  EXPECT_EQ(tile.invalid_samples, 0u);
  const double a = 0.5 * 0.7, b = 2.0 * 0.7;
  expect_all_pixels(tile, 256, kResponseIntegral * 5.0 * (std::exp(-a) - std::exp(-b)) / (b - a));
}

// Gas of one temperature that only absorbs: B (1 - exp(-a d)). Planck's law over 500-600 nm at
// 3000 K is flat enough for Simpson's rule.
TEST_F(GridMedia, GlowingSlab) {
  test::SceneBuilder builder;
  const auto index =
      builder.add_medium(builder.add_spectrum(1.3f), builder.add_spectrum(0.0f), 0.0);
  auto& medium = *builder.message.mutable_media(static_cast<int>(index));
  set_grid(builder, *medium.mutable_grid(), "density", [](int) { return 1.0f; });
  set_grid(builder, *medium.mutable_temperature(), "temperature", [](int) { return 3000.0f; });
  medium.set_emission_scale(2.0);
  const auto planck = [](double nm) {
    const double h = 6.62607015e-34, c = 299792458.0, k = 1.380649e-23, l = nm * 1e-9;
    return 2 * h * c * c / std::pow(l, 5) / std::expm1(h * c / (l * k * 3000.0)) * 1e-9;
  };
  double integral = 0.0;
  for (int i = 0; i < 10; ++i) {
    const double nm = 500.0 + 10.0 * i;
    integral += 10.0 / 6.0 * (planck(nm) + 4.0 * planck(nm + 5.0) + planck(nm + 10.0));
  }
  expect_all_pixels(trace(builder), 256, 2.0 * integral * (1.0 - std::exp(-1.3)));
}

// A body without an index is not seen; a dielectric in it keeps it out, unless it has the higher
// priority. Looking at the sky through a slab of absorbing medium with a clear slab of index 1 in
// the middle.
TEST(MediaAndDielectrics, HigherPriorityIsThere) {
  for (const int priority : {0, 1}) {
    test::SceneBuilder builder;
    builder.look({0, 0, 4}, {0, 0, 0}, 1e-3);
    builder.message.mutable_environment()->set_constant(builder.add_spectrum(1.0f));
    const auto medium =
        builder.add_medium(builder.add_spectrum(1.0f), builder.add_spectrum(0.0f), 0.0);
    builder.add_matched_box({-9, -9, -1}, {9, 9, 1}, {medium});
    builder.message.mutable_interiors(0)->set_priority(priority);
    builder.add_glass_box({-5, -5, -0.5f}, {5, 5, 0.5f}, 1.0f);
    builder.message.mutable_tracing()->set_estimator(v1::ESTIMATOR_TWO_PHOTONS);
    const auto tile = trace_tile(*builder.load(), {16, 16}, {0, 0, 16, 16, 0, 256});
    SCOPED_TRACE(priority);
    expect_all_pixels(tile, 256, kResponseIntegral * std::exp(priority == 0 ? -1.0 : -2.0));
  }
}

}  // namespace
}  // namespace nocturne

// Textures from the compiled scene to the image: a square seen by an orthographic
// sensor, with answers on paper.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <vector>

#include "support/scene_builder.h"
#include "support/texture_files.h"
#include "tracer/trace_tile.h"

namespace nocturne {
namespace {

using test::kResponseIntegral;
using test::Picture;

// The unit square in z = 0 with its normal, u and v along +z, +x and +y. The sensor looks at
// all of it from above, so pixel (x, y) of an n x n film is part (x, y) of the picture, rows from
// the top down.
class TexturedSquare : public testing::Test {
 protected:
  TexturedSquare() {
    builder_.add_quad(0.5f, 0.0f, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    auto& sensor = *message().mutable_sensor();
    sensor.set_model(v1::SENSOR_MODEL_ORTHOGRAPHIC);
    test::SceneBuilder::set(*sensor.mutable_position(), {0.5f, 0.5f, 1.0f});
    sensor.set_height(1.0);
    auto& t = *message().mutable_tracing();
    t.set_h(1e6);  // no roulette
  }

  v1::CompiledScene& message() { return builder_.message; }
  v1::TextureUse use(const Picture& picture, bool clamp = false) {
    return files_.use(message(), picture, clamp);
  }

  // Radiance 1 from everywhere; photons from the kernel alone.
  void under_uniform_sky() {
    message().mutable_environment()->set_constant(builder_.add_spectrum(1.0f));
    message().mutable_tracing()->set_weight_kernel(1);
    message().mutable_tracing()->set_weight_luminaires(0);
  }

  // A disc of radiance 1, and photons towards it alone.
  void under_disc(Vec3 direction) {
    auto& disc = *message().add_distant_discs();
    test::SceneBuilder::set(*disc.mutable_direction(), normalized(direction));
    disc.set_half_angle(kHalfAngle);
    disc.set_radiance(builder_.add_spectrum(1.0f));
    message().mutable_tracing()->set_weight_kernel(0);
    message().mutable_tracing()->set_weight_luminaires(0);
    message().mutable_tracing()->set_weight_environment(1);
  }
  // Of reflectance 1/2, whose normal has that cosine with the disc's centre: rho/pi x pi sin^2 x
  // cos.
  static double under_disc_of(double cosine) {
    return 0.5 * std::pow(std::sin(kHalfAngle), 2) * cosine;
  }

  TileSums trace(std::uint32_t edge, std::uint32_t samples) {
    return trace_tile(*load_scene(message(), files_.find_blob()), Film{edge, edge},
                      {0, 0, edge, edge, 0, samples});
  }
  static double y(const TileSums& tile, std::size_t pixel, std::uint32_t samples) {
    return tile.sums[tile.channels * pixel + 1] / samples / kResponseIntegral;
  }

  // 4.4 standard errors and rounding: 16 pixels give one false alarm in 5000 for other seeds.
  void expect_everywhere(double truth) {
    constexpr std::uint32_t kSamples = 64;
    const TileSums tile = trace(4, kSamples);
    EXPECT_EQ(tile.invalid_samples, 0u);
    for (std::size_t i = 0; i < 16; ++i) {
      const double* sums = &tile.sums[tile.channels * i];
      const double variance = (sums[3] - sums[1] * sums[1] / kSamples) / (kSamples - 1.0);
      const double error = std::sqrt(std::max(0.0, variance) / kSamples) / kResponseIntegral;
      EXPECT_NEAR(y(tile, i, kSamples), truth, 4.4 * error + 1e-5 * truth) << "pixel " << i;
    }
  }

  static constexpr double kHalfAngle = 0.01;
  test::SceneBuilder builder_;
  test::TextureFiles files_;
};

// 8 x 8 blocks of 16 texels, each seen by 4 x 4 pixels. The middle four lie far enough from the
// edges of their block that the footprint, 4 texels, sees the block alone.
constexpr int kBlock = 16, kBlocks = 8;
constexpr std::uint32_t kEdge = 32;

float block_value(int x, int y) {
  return (x + y) % 2 == 0 ? 0.125f + 0.0625f * static_cast<float>(x)
                          : 0.75f - 0.03125f * static_cast<float>(y);
}

Picture blocks() {
  return Picture::of(kBlock * kBlocks, kBlock * kBlocks,
                     [](int x, int y) { return block_value(x / kBlock, y / kBlock); });
}

template <class Expect>
void for_each_inner_pixel(const Expect& expect) {
  for (std::size_t row = 0; row < kEdge; ++row) {
    for (std::size_t column = 0; column < kEdge; ++column) {
      if ((row % 4 == 1 || row % 4 == 2) && (column % 4 == 1 || column % 4 == 2)) {
        expect(row * kEdge + column, static_cast<int>(column / 4), static_cast<int>(row / 4));
      }
    }
  }
}

// Under a uniform sky a convex diffuse surface shows its reflectance; drawn from the cosine,
// without any noise.
TEST_F(TexturedSquare, ShowsTheTexels) {
  under_uniform_sky();
  auto& reflectance = *message().mutable_kernels(0)->mutable_lambertian()->mutable_reflectance();
  *reflectance.mutable_texture() = use(blocks());
  for (const std::uint32_t group : {1u, 4u}) {
    message().mutable_tracing()->set_group(group);
    const TileSums tile = trace(kEdge, 8);
    for_each_inner_pixel([&](std::size_t pixel, int x, int row) {
      EXPECT_NEAR(y(tile, pixel, 8), 0.5 * block_value(x, row), 1e-5) << x << ' ' << row;
    });
  }
}

TEST_F(TexturedSquare, ShowsColoursByTheirSpectra) {
  under_uniform_sky();
  Picture colours{2, 1, 3, {0.25f, 0.25f, 0.25f, 0.5f, 0.1f, 0.2f}};
  auto& reflectance = *message().mutable_kernels(0)->mutable_lambertian()->mutable_reflectance();
  *reflectance.mutable_texture() = use(colours);
  reflectance.mutable_texture()->set_scale_u(0.0);
  // A table whose colours all are 0.8: c2 = 0.3 / sqrt(0.8 x 0.2) = 0.75.
  const auto path = files_.next_path();
  std::vector<float> table{0.0f, 1.0f};
  for (int i = 0; i < 24; ++i) table.insert(table.end(), {0.0f, 0.0f, 0.75f});
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(table.data()),
             static_cast<std::streamsize>(4 * table.size()));
  message().mutable_rgb_table()->set_blob(files_.last_digest());
  message().mutable_rgb_table()->set_resolution(2);
  for (const bool grey : {true, false}) {
    reflectance.mutable_texture()->set_offset_u(grey ? 0.25 : 0.75);
    const TileSums tile = trace(2, 8);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(y(tile, i, 8), 0.5 * (grey ? 0.25 : 0.8), 1e-5);
    }
  }
}

// A black square with holes: black or sky.
TEST_F(TexturedSquare, OpacityMasksShowWhatIsBehind) {
  under_uniform_sky();
  message().mutable_spectra(0)->set_values(0, 0.0f);
  const v1::TextureUse mask = use(Picture::of(kBlock * kBlocks, kBlock * kBlocks, [](int x, int y) {
    return static_cast<float>((x / kBlock + y / kBlock) % 2);
  }));
  message().add_kernels()->mutable_null_kernel();
  auto& blend = *message().add_kernels()->mutable_blend();
  for (std::uint32_t part = 0; part < 2; ++part) {
    auto& added = *blend.add_parts();
    added.set_kernel(part);
    auto& factor = *added.add_factors();
    *factor.mutable_weight()->mutable_texture() = mask;
    factor.set_complement(part == 1);
  }
  message().mutable_surfaces(0)->set_kernel(2);
  const TileSums tile = trace(kEdge, 8);
  for_each_inner_pixel([&](std::size_t pixel, int x, int row) {
    EXPECT_NEAR(y(tile, pixel, 8), (x + row) % 2 == 1 ? 0.0 : 1.0, 1e-5) << x << ' ' << row;
  });
}

TEST_F(TexturedSquare, LuminairesShowTheirTexels) {
  auto& luminaire = *message().add_luminaires();
  luminaire.set_surface(0);
  luminaire.mutable_radiance()->set_spectrum(builder_.add_spectrum(3.0f));
  *luminaire.mutable_radiance()->mutable_texture() = use(blocks());
  const TileSums tile = trace(kEdge, 4);
  for_each_inner_pixel([&](std::size_t pixel, int x, int row) {
    EXPECT_NEAR(y(tile, pixel, 4), 3.0 * block_value(x, row), 1e-5) << x << ' ' << row;
  });
}

// The same numbers, so the same bits.
TEST_F(TexturedSquare, RoughnessFromATextureIsThatRoughness) {
  under_disc({0.3f, 0.2f, 1.0f});
  auto& conductor = *message().mutable_kernels(0)->mutable_conductor();
  conductor.set_n(builder_.add_spectrum(0.2f));
  conductor.set_k(builder_.add_spectrum(3.0f));
  auto& roughness = *conductor.mutable_roughness();
  roughness.mutable_alpha_u()->set_constant(0.5);
  roughness.mutable_alpha_v()->set_constant(0.25);
  const TileSums constant = trace(4, 16);
  *roughness.mutable_alpha_u()->mutable_texture() = use({1, 1, 1, {0.5f}});
  *roughness.mutable_alpha_v()->mutable_texture() = use({2, 2, 1, {0.25f, 0.25f, 0.25f, 0.25f}});
  EXPECT_EQ(trace(4, 16).sums, constant.sums);
  EXPECT_GT(constant.sums[1], 0.0);
}

TEST_F(TexturedSquare, AFlatNormalMapChangesNothing) {
  under_disc({0.3f, -0.2f, 1.0f});
  const double cosine = 1.0 / std::sqrt(1.0 + 0.09 + 0.04);
  expect_everywhere(under_disc_of(cosine));
  *message().mutable_surfaces(0)->mutable_normal_map() = use({1, 1, 3, {0.5f, 0.5f, 1.0f}});
  expect_everywhere(under_disc_of(cosine));
}

TEST_F(TexturedSquare, ANormalMapTurnsTheNormal) {
  under_disc({0.3f, -0.2f, 1.0f});
  *message().mutable_surfaces(0)->mutable_normal_map() =
      use({1, 1, 3, {0.5f + 0.5f * 0.48f, 0.5f + 0.5f * 0.6f, 0.5f + 0.5f * 0.64f}});
  expect_everywhere(under_disc_of((0.3 * 0.48 - 0.2 * 0.6 + 0.64) / std::sqrt(1.13)));
}

// Heights that rise by `slope_x` and `slope_y` turn the normal to (-slope_x, -slope_y, 1). The
// picture's edges, where the ramp repeats, are out of sight.
TEST_F(TexturedSquare, ABumpMapTurnsTheNormalByItsSlope) {
  message().mutable_sensor()->set_height(0.5);
  under_disc({0.3f, -0.2f, 1.0f});
  constexpr double kSlopeX = 0.5, kSlopeY = 0.25;
  auto& bump = *message().mutable_surfaces(0)->mutable_bump_map();
  bump = use(Picture::of(256, 256, [](int x, int y_down) {
    const float x_at = (static_cast<float>(x) + 0.5f) / 256.0f;
    const float y_at = 1.0f - (static_cast<float>(y_down) + 0.5f) / 256.0f;
    return static_cast<float>(kSlopeX) * x_at + static_cast<float>(kSlopeY) * y_at;
  }));
  const auto truth = [](double gain) {
    const double x = -gain * kSlopeX, y_at = -gain * kSlopeY;
    return under_disc_of((0.3 * x - 0.2 * y_at + 1.0) /
                         std::sqrt((x * x + y_at * y_at + 1.0) * 1.13));
  };
  for (const double gain : {1.0, -1.0, 0.1}) {
    bump.set_gain(gain);
    SCOPED_TRACE(gain);
    expect_everywhere(truth(gain));
  }
}

struct Damage {
  const char* says;
  std::function<void(v1::CompiledScene&)> apply;
};

TEST_F(TexturedSquare, DamagedUsesAreRefusedInWords) {
  auto& reflectance = *message().mutable_kernels(0)->mutable_lambertian()->mutable_reflectance();
  *reflectance.mutable_texture() = use(blocks());
  const Damage damages[] = {
      {"texture index",
       [](auto& m) {
         m.mutable_kernels(0)
             ->mutable_lambertian()
             ->mutable_reflectance()
             ->mutable_texture()
             ->set_texture(1);
       }},
      {"scale is not finite",
       [](auto& m) {
         m.mutable_kernels(0)
             ->mutable_lambertian()
             ->mutable_reflectance()
             ->mutable_texture()
             ->set_scale_u(std::numeric_limits<double>::infinity());
       }},
      {"neither 1 nor 3", [](auto& m) { m.mutable_textures(0)->set_channels(2); }},
      {"channels", [](auto& m) { m.mutable_textures(0)->set_channels(3); }},
      {"cannot read", [](auto& m) { m.mutable_textures(0)->set_blob(std::string(32, 'x')); }},
      {"SHA-256", [](auto& m) { m.mutable_textures(0)->set_blob("x"); }},
      {"another number of channels",
       [](auto& m) {
         *m.mutable_surfaces(0)->mutable_normal_map() =
             m.kernels(0).lambertian().reflectance().texture();
       }},
      {"resolution", [](auto& m) { m.mutable_rgb_table()->set_resolution(65); }},
      {"another length",
       [](auto& m) {
         m.mutable_rgb_table()->set_resolution(2);
         m.mutable_rgb_table()->set_blob(m.textures(0).blob());
       }},
  };
  const v1::CompiledScene good = message();
  EXPECT_NO_THROW(load_scene(good, files_.find_blob()));
  for (const Damage& damage : damages) {
    v1::CompiledScene damaged = good;
    damage.apply(damaged);
    try {
      load_scene(damaged, files_.find_blob());
      ADD_FAILURE() << "accepted: " << damage.says;
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find(damage.says), std::string::npos) << error.what();
    }
  }
}

TEST_F(TexturedSquare, AColourNeedsTheTable) {
  *message().mutable_kernels(0)->mutable_lambertian()->mutable_reflectance()->mutable_texture() =
      use({1, 1, 3, {0.1f, 0.2f, 0.3f}});
  EXPECT_THROW(load_scene(message(), files_.find_blob()), SceneError);
}

}  // namespace
}  // namespace nocturne

// Scenes with an answer on paper, at every pixel, for both methods.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "baselines/trace_tile.h"
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
  double kernel, luminaires, uniform;
  v1::Estimator estimator = v1::ESTIMATOR_MIXTURE;
  std::uint32_t group = 1;
  v1::SampleSequence sequence = v1::SAMPLE_SEQUENCE_SOBOL;
  bool path_tracing = false;
};

class Truths : public testing::TestWithParam<Variant> {
 protected:
  TileSums trace(test::SceneBuilder& builder, std::uint32_t samples) const {
    auto& tracing = *builder.message.mutable_tracing();
    tracing.set_sequence(GetParam().sequence);
    tracing.set_weight_kernel(GetParam().kernel);
    tracing.set_weight_luminaires(GetParam().luminaires);
    tracing.set_weight_uniform(GetParam().uniform);
    tracing.set_estimator(GetParam().estimator);
    tracing.set_split_vertices(2);
    tracing.set_group(GetParam().group);
    const std::uint32_t edge = test::film_edge(16);
    const TileRange range{0, 0, edge, edge, 0, samples};
    const auto scene = builder.load();
    return GetParam().path_tracing ? baselines::trace_tile_by_paths(*scene, {edge, edge}, range)
                                   : trace_tile(*scene, {edge, edge}, range);
  }
};

// Inside a closed Lambertian box of albedo a whose walls all emit L, radiance is L / (1 - a)
// everywhere. The brightest box is left to mixtures in which the kernel has most of the weight:
// with less, weights double at some vertices, and 512 samples are too few to know the standard
// error of so skewed a sum.
TEST_P(Truths, Furnace) {
  for (const double albedo : {0.0, 0.5, GetParam().kernel > 0.5 ? 0.9 : 0.6}) {
    test::SceneBuilder builder;
    builder.add_furnace(static_cast<float>(albedo), 2.0f);
    const double truth = kResponseIntegral * 2.0 / (1.0 - albedo);
    SCOPED_TRACE("albedo " + std::to_string(albedo));
    expect_all_pixels(trace(builder, 512), 512, truth);
  }
}

// The same inside an emitting sphere.
TEST_P(Truths, SphericalFurnace) {
  test::SceneBuilder builder;
  builder.add_sphere(0.6f, 3.0f, {0.1f, 0.0f, -0.2f}, 2.0);
  builder.message.mutable_luminaires(0)->set_two_sided(true);
  expect_all_pixels(trace(builder, 512), 512, kResponseIntegral * 3.0 / 0.4);
}

// A spherical lamp of radius r, its centre h above a Lambertian plane, gives irradiance pi L
// (r/h)^2 right below it (form factor of a sphere to a point of a plane that it does not cut), so
// radiance rho L (r/h)^2.
TEST_P(Truths, SphereOverPlane) {
  test::SceneBuilder builder;
  builder.add_sphere(0.0f, 10.0f, {0, 3, 0}, 1.0);
  builder.add_quad(0.5f, 0.0f, {-50, 0, -50}, {0, 0, 100}, {100, 0, 0});
  // Look down at the point below from next to the lamp, through so small a field that the
  // irradiance is the same.
  builder.look({4, 4, 0}, {0, 0, 0}, 1e-3);
  expect_all_pixels(trace(builder, 1024), 1024, kResponseIntegral * 0.5 * 10.0 / 9.0);
}

// A square lamp of side a, parallel to the plane at height h, centred above the point: the form
// factor of four quarter rectangles (Howell, configuration B-3): F = 4/(2 pi) * 2 X/sqrt(1+X^2)
// atan(X/sqrt(1+X^2)), X = a/(2h).
TEST_P(Truths, SquareOverPlane) {
  test::SceneBuilder builder;
  builder.add_quad(0.0f, 10.0f, {-1, 2, -1}, {2, 0, 0}, {0, 0, 2});
  builder.add_quad(0.5f, 0.0f, {-50, 0, -50}, {0, 0, 100}, {100, 0, 0});
  builder.look({4, 1, 0}, {0, 0, 0}, 1e-3);
  const double x = 0.5, root = std::sqrt(1 + x * x);
  const double form_factor = 4.0 / (2.0 * std::numbers::pi) * 2.0 * x / root * std::atan(x / root);
  expect_all_pixels(trace(builder, 1024), 1024, kResponseIntegral * 0.5 * 10.0 * form_factor);
}

// Seen from the corner below it: a differential element parallel to a rectangle a x b at height h,
// X = a/h, Y = b/h (Howell, configuration B-3).
double corner_form_factor(double x, double y) {
  const double rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2.0 * std::numbers::pi);
}

// The same square next to a perfect mirror (n = 0), which shows another one, 2 to 4 away. If
// photons towards lamps are only shadow rays, its light reaches the floor by photons from the
// kernel alone: a lamp behind the mirror, which is aimed at as well, takes nothing from them.
TEST_P(Truths, SquareBesideMirror) {
  if (GetParam().kernel == 0.0) GTEST_SKIP() << "mirrors are drawn from the kernel";
  test::SceneBuilder builder;
  builder.add_quad(0.0f, 10.0f, {-1, 2, -1}, {2, 0, 0}, {0, 0, 2});
  builder.add_quad(0.5f, 0.0f, {-50, 0, -50}, {0, 0, 100}, {100, 0, 0});
  builder.add_quad(0.0f, 0.0f, {-1.5f, 0, -20}, {0, 20, 0}, {0, 0, 40});
  auto& mirror = *builder.message.mutable_kernels(2)->mutable_conductor();
  mirror.set_n(builder.add_spectrum(0.0f));
  mirror.set_k(builder.add_spectrum(2.0f));
  mirror.mutable_roughness()->mutable_alpha_u()->set_constant(0.0);
  mirror.mutable_roughness()->mutable_alpha_v()->set_constant(0.0);
  builder.look({4, 1, 0}, {0, 0, 0}, 1e-3);
  builder.add_quad(0.0f, 10.0f, {-4, 2, -1}, {2, 0, 0}, {0, 0, 2});
  const double form_factor = 4.0 * corner_form_factor(0.5, 0.5) +
                             2.0 * (corner_form_factor(2.0, 0.5) - corner_form_factor(1.0, 0.5));
  expect_all_pixels(trace(builder, 1024), 1024, kResponseIntegral * 0.5 * 10.0 * form_factor);
}

// A lamp seen directly shows its radiance; its back side is dark.
TEST_P(Truths, LampSeenDirectly) {
  test::SceneBuilder front;
  front.add_quad(0.0f, 7.0f, {-9, -9, -3}, {18, 0, 0}, {0, 18, 0});
  expect_all_pixels(trace(front, 16), 16, kResponseIntegral * 7.0);
  test::SceneBuilder back;
  back.add_quad(0.0f, 7.0f, {-9, -9, -3}, {0, 18, 0}, {18, 0, 0});
  expect_all_pixels(trace(back, 16), 16, 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    All, Truths,
    testing::Values(Variant{"Mixture", 0.65, 0.35, 0}, Variant{"HalfAndHalf", 0.5, 0.5, 0},
                    Variant{"ThreeParts", 0.3, 0.3, 0.4},
                    Variant{"Independent", 0.65, 0.35, 0, v1::ESTIMATOR_MIXTURE, 1,
                            v1::SAMPLE_SEQUENCE_INDEPENDENT},
                    Variant{"KernelOnly", 1, 0, 0}, Variant{"UniformOnly", 0, 0, 1},
                    Variant{"MixtureOfFour", 0.65, 0.35, 0, v1::ESTIMATOR_MIXTURE, 4},
                    Variant{"Split", 0.65, 0.35, 0, v1::ESTIMATOR_SPLIT},
                    Variant{"SplitOfFour", 0.5, 0.3, 0.2, v1::ESTIMATOR_SPLIT, 4},
                    Variant{"TwoPhotons", 0.65, 0.35, 0, v1::ESTIMATOR_TWO_PHOTONS},
                    Variant{"TwoPhotonsOfFour", 0.65, 0.35, 0, v1::ESTIMATOR_TWO_PHOTONS, 4},
                    Variant{.name = "PathTracing",
                            .kernel = 0.65,
                            .luminaires = 0.35,
                            .uniform = 0,
                            .path_tracing = true}),
    [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace nocturne

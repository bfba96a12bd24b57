// All densities of directions towards light together.
#include "luminaires/light_sampler.h"

#include <array>
#include <cmath>
#include <limits>

#include "support/chi_square.h"
#include "support/irradiance.h"
#include "surfaces/geometry.h"

namespace nocturne {
namespace {

using Corners = std::array<Vec3, 3>;

Elements lamp() {
  Elements e;
  const Corners c{Vec3{-1, -1, 1.5f}, Vec3{-1, 1, 1.5f}, Vec3{1, -1, 1.5f}};  // emits down
  e.add_parallelogram({&c, 1}, {1.0f, false});
  return e;
}

Elements opening() {
  Elements e;
  const Sphere s{2, 0, 0.5, 0.8};
  e.add_sphere({&s, 1}, {1.0f, true});
  return e;
}

std::vector<DistantDisc> suns() {
  std::vector<DistantDisc> discs;
  discs.emplace_back(normalized({0, 1, 0.4f}), 0.4, Spectrum(3.0f));
  discs.emplace_back(Vec3{0, 0, -1}, 0.3, Spectrum(5.0f));
  return discs;
}

void expect_consistent(const LightSampler& directions, const LightSamplingContext& from) {
  ASSERT_FALSE(directions.empty());
  test::expect_samples_match_pdf(
      [&](const Uniform4& u) -> std::optional<Vec3> {
        const auto drawn = directions.sample(from, u[0], u[1], u[2]);
        if (!drawn) return std::nullopt;
        return drawn->direction;
      },
      [&](Vec3 w) { return directions.pdf(from, w); });
}

std::optional<LightSampler::LightSample> sample_light(const LightSampler& directions,
                                                      const LightSamplingContext& from,
                                                      const Uniform4& u) {
  LightSampler::LightSample light, in_two_steps;
  const bool found = directions.sample_light(from, u[0], u[1], u[2], {}, light);
  const auto begun = directions.begin_light(from, u[0], u[1], u[2]);
  EXPECT_EQ(directions.sample_light(from, u[0], u[1], u[2], begun, in_two_steps), found);
  if (!found) return std::nullopt;
  EXPECT_EQ(in_two_steps.direction, light.direction);
  EXPECT_EQ(in_two_steps.pdf, light.pdf);
  return light;
}

TEST(LightSampler, AllGroupsAndEachMissing) {
  const Vec3 n = normalized({0.2f, 0.1f, 1.0f});
  for (int missing = 0; missing < 5; ++missing) {
    const LightSampler directions(
        missing == 1 ? Elements{} : lamp(),
        missing == 2 ? std::nullopt : std::make_optional<Environment>(Spectrum(0.5f)),
        missing == 3 ? std::vector<DistantDisc>{} : suns(), missing == 4 ? Elements{} : opening(),
        {0.5f, 0.3f, 0.2f});
    expect_consistent(directions, {{0.1f, 0, 0}, n});
    expect_consistent(directions, {{0.1f, 0, 0}, n, true});
  }
}

// What a drawn direction shows is what a ray meets there: the nearest lamp, and free up to it.
TEST(LightSampler, ASampleSeesTheNearestLamp) {
  const auto quad = [](float z, float edge) {
    return quad_mesh({-edge, -edge, z}, {0, 2 * edge, 0}, {2 * edge, 0, 0});  // emits down
  };
  const Sphere ball{0.5, 0.3, 1.2, 0.25};
  const Geometry geometry({quad(1.5f, 1.0f), quad(3.0f, 2.0f), ball});
  Elements elements;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Emission emission{.radiance = 1.0f, .two_sided = false, .luminaire = i};
    if (i == 2) {
      elements.add_sphere({&ball, 1}, emission);
      continue;
    }
    const TriangleMesh mesh = i == 0 ? quad(1.5f, 1.0f) : quad(3.0f, 2.0f);
    const std::span<const Vec3> vertices(mesh.vertices);
    elements.add_mesh({&vertices, 1}, mesh.triangles, emission);
  }
  const LightSampler directions(std::move(elements),
                                std::make_optional<Environment>(Spectrum(0.5f)), {}, {},
                                {0.6f, 0.4f, 0.0f});
  const LightSamplingContext from{{0.1f, -0.2f, 0.0f}, {0, 0, 1}};
  std::array<int, 4> seen{};
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const auto u = test::numbers(i);
    const auto light = sample_light(directions, from, u);
    if (!light) continue;
    // The same number by another road: once from the point that was drawn, once from the direction.
    const float pdf = directions.pdf(from, light->direction);
    if (pdf > 0.0f) {
      EXPECT_NEAR(light->pdf / pdf, 1.0f, 1e-4f);
    }
    const auto hit = geometry.intersect({from.position, light->direction}, 0.0f);
    // Rims are met or not, up to rounding.
    if (hit.has_value() != std::isfinite(light->distance)) {
      ++seen[3];
      continue;
    }
    std::uint8_t blocked = 0;
    const TimedRay way{{from.position, light->direction}, 0.0f, light->free_distance};
    geometry.occluded({&way, 1}, {&blocked, 1});
    EXPECT_EQ(blocked, 0);
    if (!hit) {
      EXPECT_EQ(light->luminaire, Emission::kNoLuminaire);
      continue;
    }
    ASSERT_EQ(light->luminaire, hit->surface);
    ++seen[light->luminaire];
    EXPECT_NEAR(light->distance, hit->distance, 1e-5f);
    EXPECT_GT(light->free_distance, hit->distance * (1.0f - 1e-4f));
    EXPECT_NEAR(dot(light->normal, hit->normal), 1.0f, 1e-5f);
  }
  EXPECT_GT(seen[0], 1000);
  EXPECT_GT(seen[1], 100);
  EXPECT_GT(seen[2], 500);
  EXPECT_LT(seen[3], 20);
}

TEST(LightSampler, OneGroupTakesAll) {
  const LightSampler directions({}, std::nullopt, {}, opening(), {0.5f, 0.5f, 0.1f});
  const LightSamplingContext from{{0, 0, 0}, {1, 0, 0}};
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const auto u = test::numbers(i);
    ASSERT_TRUE(directions.sample(from, u[0], u[1], u[2]));
  }
  ASSERT_TRUE(directions.sample(from, 0x1.fffffep-1f, 0.5f, 0.5f));
}

TEST(LightSampler, NothingAndNoWeight) {
  const LightSampler nothing({}, Environment(Spectrum(0.0f)), {}, {}, {1, 1, 1});
  const LightSampler unwanted(lamp(), Environment(Spectrum(1.0f)), {}, {}, {0, 0, 1});
  const LightSamplingContext from{{0, 0, 0}, {0, 0, 1}};
  for (const LightSampler* d : {&nothing, &unwanted}) {
    EXPECT_TRUE(d->empty());
    EXPECT_FALSE(d->sample(from, 0.5f, 0.5f, 0.5f));
    EXPECT_EQ(d->pdf(from, Vec3{0, 0, 1}), 0.0f);
  }
  EXPECT_THROW(LightSampler({}, std::nullopt, {}, {}, {-1, 0, 0}), std::invalid_argument);
  EXPECT_THROW(
      LightSampler({}, std::nullopt, {}, {}, {0, std::numeric_limits<float>::quiet_NaN(), 0}),
      std::invalid_argument);
}

// Lamp, sun and sky over a floor, none hiding another: irradiances add up, whatever the weights.
// The lamp is a square in front of the sky: its form factor is four times that of a corner.
TEST(LightSampler, IrradianceOfAllTogether) {
  const DistantDisc sun(normalized({0, 1, 0.4f}), 0.2, Spectrum(3.0f));
  const double cosine = 0.4 / std::sqrt(1.16), x = 1.0 / 1.5, root = std::sqrt(1.0 + x * x);
  const double truth = std::numbers::pi * (0.5 + 3.0 * std::sin(0.2) * std::sin(0.2) * cosine) +
                       7.0 * 4.0 * x / root * std::atan(x / root);
  const auto radiance = [&](Vec3 w) {
    const double s = 1.5 / w.z;
    const bool on_lamp = std::fabs(s * w.x) <= 1.0 && std::fabs(s * w.y) <= 1.0;
    return 0.5 + sun.radiance(w, Spectral<1>(550.0f))[0] + (on_lamp ? 7.0 : 0.0);
  };
  for (const LightWeights& weights :
       {LightWeights{0.5f, 0.4f, 0.1f}, LightWeights{0.1f, 0.8f, 0}}) {
    const LightSampler directions(lamp(), Environment(Spectrum(0.5f)), {sun}, opening(), weights);
    test::expect_mean(test::irradiance(directions, {{0, 0, 0}, {0, 0, 1}}, radiance), truth, 1e-4);
  }
}

// A point of a lamp lies off its surface by rounding. A direction drawn from there leads to the hit
// of a ray that leaves the point, never to the point itself.
TEST(LightSampler, ALampIsNotSeenFromItsOwnPoints) {
  const Sphere cavity{0.1, -0.2, 0.3, 2.0};
  const TriangleMesh plate =
      quad_mesh({-0.7f, -0.6f, -0.5f}, {1.1f, 0.2f, 0.3f}, {-0.1f, 1.2f, 0.4f});
  const Geometry geometry({cavity, plate});
  Elements elements;
  const std::span<const Vec3> vertices(plate.vertices);
  elements.add_sphere({&cavity, 1}, {.radiance = 1.0f, .two_sided = true, .luminaire = 0});
  elements.add_mesh({&vertices, 1}, plate.triangles,
                    {.radiance = 1.0f, .two_sided = true, .luminaire = 1});
  const LightSampler directions(std::move(elements), std::nullopt, {}, {}, {1.0f, 0.0f, 0.0f});
  std::array<int, 2> left{};
  int compared = 0;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const auto towards = test::numbers(i), u = test::numbers(100'000 + i);
    const float z = 2.0f * towards[0] - 1.0f, phi = 6.2831853f * towards[1];
    const float r = std::sqrt(1.0f - z * z);
    const auto hit =
        geometry.intersect({{0.1f, 0.1f, 0.9f}, {r * std::cos(phi), r * std::sin(phi), z}}, 0.0f);
    ASSERT_TRUE(hit.has_value());
    const Vec3 side = dot(hit->normal, Vec3{r * std::cos(phi), r * std::sin(phi), z}) < 0.0f
                          ? hit->normal
                          : -hit->normal;
    const auto light = sample_light(directions, {leave_surface(*hit, side), side, true}, u);
    if (!light || dot(light->direction, side) < 0.01f) continue;
    const auto seen =
        geometry.intersect({leave_surface(*hit, light->direction), light->direction}, 0.0f);
    ASSERT_TRUE(seen.has_value());
    ++left[hit->surface];
    if (light->luminaire == seen->surface) {
      ++compared;
      EXPECT_NEAR(light->distance, seen->distance,
                  2e-5f / std::fabs(dot(light->normal, light->direction)));
    }
  }
  EXPECT_GT(left[0], 2000);
  EXPECT_GT(left[1], 200);
  // But for rims.
  EXPECT_GT(compared, (left[0] + left[1]) * 999 / 1000);
}

}  // namespace
}  // namespace nocturne

// The light of a lamp that is widened to a cone is that of the lamp.
#include "luminaires/widened_lamps.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "math/constants.h"
#include "pdfs/directions.h"

namespace nocturne {
namespace {

LightSampler directions(Elements elements, std::vector<DistantDisc> discs = {},
                        std::optional<Environment> environment = {}) {
  return {std::move(elements), std::move(environment), std::move(discs), {}, {1.0f, 1.0f, 0.0f}};
}

const auto kAll = [](HiddenFrom, Vec3, float) { return true; };

// Integral of radiance over all directions, W m-2 nm-1, by a grid.
template <class Reaches>
double light_at(const WidenedLamps& lamps, Vec3 place, const Reaches& reaches) {
  constexpr int kEdge = 1000;
  double sum = 0.0;
  for (int i = 0; i < kEdge; ++i) {
    for (int k = 0; k < kEdge; ++k) {
      const Vec3 direction = UniformSphere::sample((static_cast<float>(i) + 0.5f) / kEdge,
                                                   (static_cast<float>(k) + 0.5f) / kEdge);
      sum += double{lamps.met(place, direction, reaches).mean};
    }
  }
  return 4.0 * std::numbers::pi * sum / (kEdge * kEdge);
}

TEST(WidenedLamps, BringTheLightOfADisc) {
  constexpr double kHalfAngle = 0.00465;
  const auto lights = directions({}, {DistantDisc({0, 0.6f, 0.8f}, kHalfAngle, Spectrum(1e6f))});
  const WidenedLamps lamps(lights, {}, 1e5f);
  EXPECT_NEAR(light_at(lamps, {1, 2, 3}, kAll) / (1e6 * std::numbers::pi * kHalfAngle * kHalfAngle),
              1.0, 0.01);
  // A sample hits the bright source or nothing: its square is the radiance times the mean.
  const auto towards = lamps.met({1, 2, 3}, {0, 0.6f, 0.8f}, kAll);
  EXPECT_FLOAT_EQ(towards.square, 1e6f * towards.mean);
  EXPECT_EQ(light_at(lamps, {1, 2, 3}, [](HiddenFrom, Vec3, float) { return false; }), 0.0);
  EXPECT_TRUE(WidenedLamps(lights, {}, 2e6f).empty());
}

// The solid angle of 0.1 degrees is 4e-7 of the half sphere's: less than float's 1 - cosine tells.
TEST(WidenedLamps, BringTheLightOfATinyDisc) {
  constexpr double kHalfAngle = 0.05 * std::numbers::pi / 180.0;
  const auto lights = directions({}, {DistantDisc({0, 0.6f, 0.8f}, kHalfAngle, Spectrum(1e8f))});
  EXPECT_NEAR(light_at(WidenedLamps(lights, {}, 1e5f), {1, 2, 3}, kAll) /
                  (1e8 * std::numbers::pi * kHalfAngle * kHalfAngle),
              1.0, 0.01);
}

// One texel of a grey sky is 10,000 times as bright: more than half of all light.
TEST(WidenedLamps, BringTheLightOfTheSunInAPictureOfTheSky) {
  constexpr std::uint32_t kColumns = 128, kRows = 64;
  // S(x) = 1/2 + x / (2 sqrt(1 + x^2)), so that coefficients of zero are a reflectance of 1/2.
  std::vector<EnvironmentMap::Texel> texels(kColumns * kRows, {2.0f, 0.0f, 0.0f, 0.0f});
  texels[20 * kColumns + 30].scale = 2e4f;
  const auto lights = directions(
      {}, {}, Environment(EnvironmentMap(kColumns, kRows, std::move(texels), Spectrum(1.0f), {})));
  const WidenedLamps lamps(lights, {}, 1e3f);
  const double truth = 1e4 * 4.0 * std::numbers::pi / (kColumns * kRows);
  EXPECT_NEAR(light_at(lamps, {1, 2, 3}, kAll) / truth, 1.0, 0.05);
  EXPECT_TRUE(WidenedLamps(lights, {}, 2e4f).empty());
}

TEST(WidenedLamps, BringTheLightOfASphere) {
  Elements elements;
  const Sphere small{0.5, 1.6, 0.3, 1e-3};
  elements.add_sphere({&small, 1}, {.radiance = 1e6f, .luminaire = 0});
  const auto lights = directions(std::move(elements));
  const std::vector<Luminaire> luminaires{Luminaire(0, Colour(Spectrum(1e6f)), false)};
  const WidenedLamps lamps(lights, luminaires, 1e5f);
  const double truth = 1e6 * std::numbers::pi * 1e-6 / (0.25 + 2.56 + 0.09);
  EXPECT_NEAR(light_at(lamps, {0, 0, 0}, kAll) / truth, 1.0, 0.01);
  // The shadow ray to it ends in front of it.
  const double away = std::sqrt(0.25 + 2.56 + 0.09);
  const auto near = [&](HiddenFrom, Vec3 direction, float distance) {
    EXPECT_NEAR(direction.y, 1.6 / away, 1e-6);
    EXPECT_NEAR(distance, away * (1.0 - 1e-3) - 1e-3, 1e-5);
    return true;
  };
  EXPECT_GT(lamps.met({0, 0, 0}, normalized({0.5f, 1.6f, 0.3f}), near).mean, 0.0f);
}

// A tilted square shines by the cosine, on one side; of many small ones some stand for all.
TEST(WidenedLamps, BringTheLightOfPatches) {
  Elements elements;
  constexpr int kMany = 30;
  constexpr float kEdge = 1e-3f / kMany;
  for (int i = 0; i < kMany * kMany; ++i) {
    const Vec3 corner{kEdge * static_cast<float>(i % kMany), 2.0f,
                      kEdge * static_cast<float>(i / kMany)};
    const std::array<Vec3, 3> corners{corner, corner + Vec3{kEdge, 0, 0},
                                      corner + Vec3{0, 0, kEdge}};
    elements.add_parallelogram({&corners, 1}, {.radiance = 1e6f, .luminaire = 0});
  }
  const auto lights = directions(std::move(elements));
  const std::vector<Luminaire> luminaires{Luminaire(0, Colour(Spectrum(1e6f)), false)};
  const WidenedLamps lamps(lights, luminaires, 1e5f);
  // Its normal is -y.
  const double squared = 1.0 + 4.0, truth = 1e6 * 1e-6 * (2.0 / std::sqrt(squared)) / squared;
  EXPECT_NEAR(light_at(lamps, {1, 0, 0}, kAll) / truth, 1.0, 0.02);
  EXPECT_EQ(light_at(lamps, {1, 4, 0}, kAll), 0.0);
}

// A strip of 8 m is no point in its middle: it shows all along.
TEST(WidenedLamps, AreAsLongAsTheyAre) {
  Elements elements;
  const std::array<Vec3, 3> corners{Vec3{-4, 3, 0}, Vec3{4, 3, 0}, Vec3{-4, 3, 1e-4f}};
  elements.add_parallelogram({&corners, 1}, {.radiance = 1e5f, .luminaire = 0});
  const auto lights = directions(std::move(elements));
  const std::vector<Luminaire> luminaires{Luminaire(0, Colour(Spectrum(1e5f)), false)};
  const WidenedLamps lamps(lights, luminaires, 1e4f);
  // Below the middle; integral of h / (x^2 + h^2)^(3/2) over x: the sum of the sines to both ends
  // over h.
  const double truth = 1e5 * 1e-4 * 2.0 * (4.0 / 5.0) / 3.0;
  EXPECT_NEAR(light_at(lamps, {0, 0, 0}, kAll) / truth, 1.0, 0.02);
  EXPECT_GT(lamps.met({0, 0, 0}, normalized({3.9f, 3.0f, 0.0f}), kAll).mean, 0.0f);
}

}  // namespace
}  // namespace nocturne

// All ways to point at light together.
#include "luminaires/light_directions.h"

#include <limits>

#include "support/chi_square.h"
#include "support/irradiance.h"

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

void expect_consistent(const LightDirections& directions, const LightSamplingContext& from) {
  ASSERT_FALSE(directions.empty());
  test::expect_samples_match_pdf(
      [&](const Uniform4& u) { return directions.sample(from, u[0], u[1], u[2]); },
      [&](Vec3 w) { return directions.pdf(from, w); });
}

TEST(LightDirections, AllGroupsAndEachMissing) {
  const Vec3 n = normalized({0.2f, 0.1f, 1.0f});
  for (int missing = 0; missing < 5; ++missing) {
    const LightDirections directions(
        missing == 1 ? Elements{} : lamp(),
        missing == 2 ? std::nullopt : std::make_optional<Environment>(Spectrum(0.5f)),
        missing == 3 ? std::vector<DistantDisc>{} : suns(), missing == 4 ? Elements{} : opening(),
        {0.5f, 0.3f, 0.2f});
    expect_consistent(directions, {{0.1f, 0, 0}, n});
    expect_consistent(directions, {{0.1f, 0, 0}, n, true});
  }
}

TEST(LightDirections, OneGroupTakesAll) {
  const LightDirections directions({}, std::nullopt, {}, opening(), {0.5f, 0.5f, 0.1f});
  const LightSamplingContext from{{0, 0, 0}, {1, 0, 0}};
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const auto u = test::numbers(i);
    ASSERT_TRUE(directions.sample(from, u[0], u[1], u[2]));
  }
  ASSERT_TRUE(directions.sample(from, 0x1.fffffep-1f, 0.5f, 0.5f));
}

TEST(LightDirections, NothingAndNoWeight) {
  const LightDirections nothing({}, Environment(Spectrum(0.0f)), {}, {}, {1, 1, 1});
  const LightDirections unwanted(lamp(), Environment(Spectrum(1.0f)), {}, {}, {0, 0, 1});
  const LightSamplingContext from{{0, 0, 0}, {0, 0, 1}};
  for (const LightDirections* d : {&nothing, &unwanted}) {
    EXPECT_TRUE(d->empty());
    EXPECT_FALSE(d->sample(from, 0.5f, 0.5f, 0.5f));
    EXPECT_EQ(d->pdf(from, {0, 0, 1}), 0.0f);
  }
  EXPECT_THROW(LightDirections({}, std::nullopt, {}, {}, {-1, 0, 0}), std::invalid_argument);
  EXPECT_THROW(
      LightDirections({}, std::nullopt, {}, {}, {0, std::numeric_limits<float>::quiet_NaN(), 0}),
      std::invalid_argument);
}

// Lamp, sun and sky over a floor, none hiding another: irradiances add up, whatever the weights.
// The lamp is a square in front of the sky: its form factor is four times that of a corner.
TEST(LightDirections, IrradianceOfAllTogether) {
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
    const LightDirections directions(lamp(), Environment(Spectrum(0.5f)), {sun}, opening(),
                                     weights);
    test::expect_mean(test::irradiance(directions, {{0, 0, 0}, {0, 0, 1}}, radiance), truth, 1e-4);
  }
}

}  // namespace
}  // namespace nocturne

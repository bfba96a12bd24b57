// A pilot's criteria, and its choice of method. That images are the same by all methods is tested
// in tests/accuracy. Long, as it has both criteria and choices.
#include "tracer/pilot/pilot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "math/splitmix64.h"
#include "support/caustic_scene.h"
#include "tracer/learning/learn.h"
#include "tracer/pilot/compare_methods.h"
#include "tracer/pilot/rare_light.h"
#include "tracer/pilot/trials.h"

namespace nocturne {
namespace {

TEST(PilotFigures, TellHowUncertainARatioIs) {
  GroupErrors even{}, uneven{}, one{}, alone{};
  even.fill(1.0);
  for (std::size_t i = 0; i < uneven.size(); ++i) uneven[i] = i % 2 == 0 ? 0.9 : 1.1;
  EXPECT_EQ(error_of_log_ratio(even, even), 0.0);
  // Of a mean of 16 numbers that are 0.9 or 1.1: their standard deviation with 15 degrees of
  // freedom, over 4.
  EXPECT_NEAR(error_of_log_ratio(uneven, even), std::sqrt(0.01 * 16 / 15) / 4, 1e-4);
  EXPECT_NEAR(error_of_log(uneven), std::sqrt(0.01 * 16 / 15) / 4, 1e-4);
  one.fill(1e-3);
  one[3] = 1.0;
  EXPECT_GT(error_of_log_ratio(one, even), 3.0);
  alone[0] = 1.0;
  EXPECT_EQ(error_of_log_ratio(alone, even), std::numeric_limits<double>::infinity());
}

// Student's t, one-sided, of 0.999: 10.2 for 3 degrees of freedom and 3.85 for 15 (Abramowitz and
// Stegun 1964, table 26.10); the first terms of its expansion give 5.8 and 3.64.
TEST(PilotFigures, TellMeansApartByHowTheyDiffer) {
  const auto around = [](double mean, std::size_t count) {
    std::vector<double> numbers(count, mean - 1.0);
    for (std::size_t i = 0; i < count; i += 2) numbers[i] = mean + 1.0;
    return numbers;
  };
  // Standard errors of the mean: 1 / sqrt(3) and 1 / sqrt(15).
  EXPECT_FALSE(is_more(around(5.7 / std::sqrt(3.0), 4), {0, 0, 0, 0}));
  EXPECT_TRUE(is_more(around(5.9 / std::sqrt(3.0), 4), {0, 0, 0, 0}));
  const std::vector<double> zeros(16, 0.0);
  EXPECT_FALSE(is_more(around(3.5 / std::sqrt(15.0), 16), zeros));
  EXPECT_TRUE(is_more(around(3.7 / std::sqrt(15.0), 16), zeros));
  // What both have in common is none of the difference.
  EXPECT_TRUE(is_more({101, 201, 301, 401}, {100, 200, 300, 400.1}));
  EXPECT_FALSE(is_more(zeros, zeros));
}

TEST(PilotFigures, CountSamplesThatFoundLight) {
  TileSums sums(3, 1, 0);
  const auto add = [&](std::size_t pixel, double y) {
    const std::array<double, 3> xyz{0.0, y, 0.0};
    add_sample(xyz.data(), 0, &sums.sums[pixel * sums.channels]);
  };
  for (int i = 0; i < 4; ++i) add(0, 2.0);
  add(1, 1e6);
  EXPECT_DOUBLE_EQ(finds_of({.samples = 4, .images = {{sums}, {sums}}}), 2 * (4.0 + 1.0));
}

TEST(PilotOfRareLight, IsBroughtWhereOthersMissIt) {
  EXPECT_TRUE(must_be_brought({{2.0, 0.1}, {0.0, 0.0}}, 365.0));
  EXPECT_TRUE(must_be_brought({{2.0, 0.8}, {0.0, 0.0}}, 365.0));
  // However uncertain: light that was found exists.
  EXPECT_TRUE(must_be_brought({{2.0, 1.9}, {0.0, 0.0}}, 365.0));
  EXPECT_TRUE(must_be_brought({{2.0, 0.1}, {1.4, 0.2}}, 365.0));
  EXPECT_FALSE(must_be_brought({{2.0, 0.1}, {1.6, 0.2}}, 365.0));
  EXPECT_FALSE(must_be_brought({{2.0, 0.1}, {0.0, 0.0}}, 1e5));
  EXPECT_FALSE(must_be_brought({{0.0, 0.0}, {0.0, 0.0}}, 365.0));
}

TEST(PilotOfRareLight, TellsWhatMayBeMissing) {
  EXPECT_DOUBLE_EQ(may_be_missing({{2.0, 1.2}, {0.0, 0.0}}, 100.0), 0.044);
  EXPECT_DOUBLE_EQ(may_be_missing({{2.0, 0.1}, {1.0, 0.2}}, 100.0), 0.012);
  EXPECT_EQ(may_be_missing({{2.0, 0.1}, {1.9, 0.1}}, 100.0), 0.0);
  EXPECT_EQ(may_be_missing({{0.0, 0.0}, {0.0, 0.0}}, 100.0), 0.0);
}

/// Independent images of 8 x 8 pixels with a mean, and of each pixel a standard deviation.
struct Light {
  double mean, deviation;
  /// In one pixel alone.
  bool in_one_pixel = false;
};
PilotImages images_of(const Light& light, std::uint64_t seed) {
  PilotImages made{.samples = 16, .images = {}};
  std::uint64_t state = seed;
  for (int image = 0; image < 16; ++image) {
    TileSums sums(8, 8, 0);
    for (std::size_t pixel = 0; pixel < 64; ++pixel) {
      // Of a uniform number: variance 1 / 12.
      state = splitmix64(state);
      const double uniform = static_cast<double>(state >> 11) * 0x1p-53 - 0.5;
      const bool noisy = !light.in_one_pixel || pixel == 17;
      const double y = light.mean + (noisy ? light.deviation * std::sqrt(12.0) * uniform : 0.0);
      sums.sums[pixel * sums.channels + 1] = y * 16;
    }
    sums.rays = 64 * 16;
    made.images.push_back({sums});
  }
  return made;
}

const PhotonKind kAlone{}, kGuided{.guided = true}, kRest{.from = PhotonKind::kSensorOfBoth},
    kForward{.from = PhotonKind::kLuminaires};

/// Of photons from the sensor alone, guided ones, and photons from both ends.
std::vector<MethodFigures> figures(const std::map<PhotonKind, Light>& lights) {
  std::map<PhotonKind, PilotImages> images;
  std::vector<PilotMethod> methods;
  for (const auto& [kind, light] : lights) {
    images[kind] = images_of(light, images.size() + 1);
    if (kind.from == PhotonKind::kSensor) methods.push_back({kind, std::nullopt});
  }
  if (lights.contains(kForward)) methods.push_back({kRest, kForward});
  return figures_of_methods(
      methods, [&](const PhotonKind& kind) -> const PilotImages& { return images.at(kind); },
      std::nullopt);
}
PilotMethod best(const std::map<PhotonKind, Light>& lights) {
  return std::ranges::min(figures(lights), is_better).method;
}
const PilotMethod kPlain{kAlone, std::nullopt}, kBoth{kRest, kForward};

TEST(PilotOfMethods, TellsTheErrorOfASample) {
  const MethodFigures found = figures({{kAlone, {10.0, 1.0}}}).front();
  // Of 16 samples it is 1 / (1.01 x 100), as dark pixels are levelled; chi-square of 960 degrees.
  EXPECT_NEAR(found.error(), 16.0 / 101.0, 4.0 * 16.0 / 101.0 * std::sqrt(2.0 / 960));
  EXPECT_DOUBLE_EQ(found.cost(), 1.0);
  EXPECT_NEAR(found.mean.mean, 10.0, 4.0 / 32);
}

TEST(PilotOfMethods, TakesLessErrorForTheSameCost) {
  EXPECT_EQ(best({{kAlone, {10, 2}}, {kGuided, {10, 1}}}).sensor, kGuided);
  // A guided photon costs 1.1.
  EXPECT_EQ(best({{kAlone, {10, 1}}, {kGuided, {10, 1}}}).sensor, kAlone);
  EXPECT_EQ(best({{kAlone, {10, 4}}, {kRest, {6, 1}}, {kForward, {4, 1}}}), kBoth);
}

TEST(PilotOfMethods, DistrustsWhatFewPixelsSay) {
  // As much error, in one pixel and in all.
  const auto few = figures({{kAlone, {10, 8, true}}}).front(),
             many = figures({{kAlone, {10, 1}}}).front();
  EXPECT_NEAR(few.error() / many.error(), 1.0, 0.3);
  EXPECT_GT(few.merit() / few.product(), 1.5);
  EXPECT_LT(many.merit() / many.product(), 1.1);
}

// Light that photons from the sensor met in none of the pilot's samples costs less than finding it.
TEST(PilotOfMethods, TakesBothEndsUnlessOneIsSurelyBetter) {
  EXPECT_EQ(best({{kAlone, {10, 1}}, {kRest, {9, 0.96}}, {kForward, {1, 0.05}}}), kBoth);
  const auto handicap = [](bool in_one_pixel) {
    return figures({{kAlone, {10, 1, in_one_pixel}}, {kRest, {9, 1}}, {kForward, {1, 0.05}}})
        .front()
        .handicap;
  };
  // By one pixel nothing is sure; by as many as there are, a little is.
  EXPECT_EQ(handicap(true), kWorthIt);
  EXPECT_GT(handicap(false), 1.0);
  EXPECT_LT(handicap(false), kWorthIt);
  EXPECT_EQ(best({{kAlone, {10, 1}}, {kRest, {9, 2}}, {kForward, {1, 1}}}), kPlain);
}

TEST(PilotOfMethods, NeverTakesWhatMissesLight) {
  const auto found = figures({{kAlone, {10, 0.01}}, {kRest, {6, 1}}, {kForward, {5, 1}}});
  EXPECT_TRUE(found.front().misses_light);
  EXPECT_FALSE(found.back().misses_light);
  EXPECT_EQ(best({{kAlone, {10, 0.01}}, {kRest, {6, 1}}, {kForward, {5, 1}}}), kBoth);
  // And the other way round.
  EXPECT_EQ(best({{kAlone, {10, 1}}, {kRest, {6, 0.01}}, {kForward, {3, 0.01}}}), kPlain);
}

// Where a guide was chosen, the plainest method is the only one without it.
TEST(PilotOfMethods, LooksForRareLightByPhotonsFromLuminaires) {
  PhotonKind guided_rest = kRest, aimed = kForward;
  guided_rest.guided = true;
  aimed.aimed = 0.6f;
  const std::map<PhotonKind, PilotImages> images{{kForward, images_of({1, 0.5}, 1)},
                                                 {aimed, images_of({1, 0.1}, 2)}};
  const auto surest = [&](const std::vector<PilotMethod>& methods) {
    return surest_from_luminaires(
        methods, kAlone, [&](const PhotonKind& kind) -> const auto& { return images.at(kind); });
  };
  const PilotMethod guided{guided_rest, kForward}, surer{guided_rest, aimed};
  EXPECT_EQ(surest({kPlain, {kGuided, {}}, guided, surer}), surer);
  EXPECT_EQ(surest({kPlain, surer, kBoth}), kBoth);
}

TEST(PilotOfMethods, NeverTakesPhotonsThatHardlyFoundTheSensor) {
  EXPECT_EQ(best({{kAlone, {10, 5}}, {kRest, {10, 0.01}}, {kForward, {0, 0}}}), kPlain);
  // A mean of 0.1 with an error of 0.06.
  EXPECT_EQ(best({{kAlone, {10, 5}}, {kRest, {10, 0.01}}, {kForward, {0.1, 2}}}), kPlain);
}

// Costs and errors of two that share the time: the best parts are as the roots of error over cost.
TEST(PilotOfMethods, GivesEachKindAsManyPhotonsAsPay) {
  const auto ratio = [](double sensor_mse, double forward_mse, double forward_cost,
                        double about = 1.0) {
    PilotFigures sensor, forward;
    sensor.relative_mse = sensor_mse;
    sensor.cost = 1.0;
    forward.relative_mse = forward_mse;
    forward.cost = forward_cost;
    return best_forward_ratio(sensor, forward, about);
  };
  EXPECT_EQ(ratio(1.0, 1.0, 1.0), 1.0);
  EXPECT_EQ(ratio(1.0, 16.0, 1.0), 4.0);
  EXPECT_EQ(ratio(16.0, 1.0, 1.0), 0.25);
  EXPECT_EQ(ratio(1.0, 16.0, 0.25), 8.0);
  // Error times cost is 25 at 4, and 27 at 8.
  EXPECT_EQ(ratio(1.0, 16.0, 1.0, 1.07), 4.0);
  EXPECT_EQ(ratio(1.0, 16.0, 1.0, 1.09), 8.0);
  // Each keeps a sixteenth of the time: at a ratio of 8 a ninth.
  EXPECT_EQ(ratio(0.0, 1.0, 1.0), 8.0);
  EXPECT_EQ(ratio(1.0, 0.0, 1.0), 0.125);
}

TEST(PilotOfMethods, ListsWhatIsOpen) {
  TracingOptions given{};
  given.direction = Direction::kBoth;
  given.aimed_emission = 0.6f;
  const auto count = [&](bool direction, bool aim, bool guide) {
    return methods_of({direction, aim, guide}, given, true).size();
  };
  EXPECT_EQ(count(false, false, false), 1u);
  EXPECT_EQ(count(false, true, true), 2u);
  EXPECT_EQ(count(true, false, false), 2u);
  EXPECT_EQ(count(true, true, false), 3u);
  EXPECT_EQ(count(true, true, true), 6u);
  EXPECT_EQ(methods_of({true, true, true}, given, true).front(), kPlain);
  given.direction = Direction::kForward;
  EXPECT_EQ(count(true, true, true), 4u);
  EXPECT_EQ(count(false, true, true), 1u);
  given.direction = Direction::kAdjoint;
  EXPECT_EQ(count(true, true, true), 2u);
}

PilotResult pilot(const test::SceneBuilder& builder, bool direction, std::uint32_t samples = 4096) {
  return run_pilot(*builder.load(), {.film = {64, 48},
                                     .samples = samples,
                                     .direction = direction,
                                     .aim = false,
                                     .sharing = true,
                                     .threads = 2});
}

// Of a film of 64 x 48: a quarter of a million in all, a render of a second.
constexpr std::uint32_t kFewSamples = 86;

// A lamp that shines at the ceiling alone.
test::SceneBuilder lit_by_its_ceiling(float albedo = 0.7f) {
  test::SceneBuilder builder = test::two_photons();
  builder.add_furnace(albedo, 0.0f);
  builder.add_quad(0.0f, 50.0f, {-0.2f, 0.5f, -0.2f}, {0, 0, 0.4f}, {0.4f, 0, 0});
  return builder;
}

TEST(Pilot, SharesWhereLightComesByOtherSurfaces) {
  for (const std::uint32_t samples : {kFewSamples, 4096u}) {
    const PilotResult found = pilot(lit_by_its_ceiling(), false, samples);
    EXPECT_EQ(found.choice.sharing, 16u);
    EXPECT_GT(found.choice.gain, 2.0);
  }
}

TEST(Pilot, LeavesPixelsAloneInDirectLight) {
  for (const std::uint32_t samples : {kFewSamples, 4096u}) {
    const PilotResult found = pilot(test::floor_and_lamp(false), false, samples);
    EXPECT_EQ(found.choice.sharing, 1u);
    EXPECT_EQ(found.choice.gain, 1.0);
  }
}

TEST(Pilot, StartsPhotonsAtTheLampForACaustic) {
  for (const std::uint32_t samples : {kFewSamples, 4096u}) {
    const PilotResult found = pilot(test::floor_and_lamp(true), true, samples);
    EXPECT_EQ(found.choice.direction, Direction::kBoth);
    // Photons from the camera hardly ever get through the glass to so small a lamp.
    EXPECT_TRUE(found.choice.finds_more || found.choice.gain > 5.0);
  }
}

// Photons that are not guided only trace shadow rays to the lamp, in directions that learned light
// has no part in; guided ones that did so looked a fifth too bright.
TEST(Pilot, GuidesPhotonsThatFindTheSameLight) {
  test::SceneBuilder builder = test::floor_and_lamp(false);
  builder.message.mutable_tracing()->set_direction(v1::DIRECTION_BOTH);
  builder.message.clear_luminaires();
  // So large that photons from the kernel count as much as those that are sent to it.
  builder.add_quad(0.0f, 10.0f, {-2, 2, -2}, {4, 0, 0}, {0, 0, 4});
  builder.add_quad(0.5f, 0.0f, {-2, -1, -2}, {4, 0, 0}, {0, 4, 0});
  const int last = builder.message.kernels_size() - 1;
  auto& mirror = *builder.message.mutable_kernels(last)->mutable_conductor();
  mirror.set_n(builder.add_spectrum(0.0f));
  mirror.set_k(builder.add_spectrum(5.0f));
  mirror.mutable_roughness()->mutable_alpha_u()->set_constant(0.0);
  mirror.mutable_roughness()->mutable_alpha_v()->set_constant(0.0);
  const auto scene = builder.load();
  ASSERT_TRUE(scene->shadow_rays_suffice);
  const Learned learned = learn(*scene, {64, 48}, 1 << 18, 2);
  ASSERT_GT(learned.arrivals.size(), 1000u);
  scene->lights.set_learned(LearnedLight(learned.arrivals));
  constexpr Film kFilm{64, 48};
  Trials trials(*scene, kFilm, 2);
  const auto light_of = [&](const PhotonKind& kind) {
    return mean_and_error(trials.images(kind, kFilm, whole(kFilm, 64), 8));
  };
  const MeanLight alone = light_of(kAlone), guided = light_of(kGuided);
  // Student's t of seven degrees: 5.4 is one in a thousand.
  EXPECT_NEAR(guided.mean, alone.mean, 5.4 * std::hypot(alone.error, guided.error));
}

void add_important_ball(test::SceneBuilder& builder, Vec3 centre, double radius) {
  auto& important = *builder.message.add_important_shapes();
  important.set_weight(1.0);
  auto& sphere = *important.mutable_sphere();
  test::SceneBuilder::set(*sphere.mutable_centre(), centre);
  sphere.set_radius(radius);
}

TEST(Pilot, AimsForwardPhotonsWhereThatHelps) {
  const auto choose = [](Vec3 aim, std::uint32_t samples) {
    test::SceneBuilder builder = test::floor_and_lamp(true);
    add_important_ball(builder, aim, 0.5);
    builder.message.mutable_tracing()->set_aimed_emission(0.9);
    return run_pilot(*builder.load(), {.film = {64, 48},
                                       .samples = samples,
                                       .direction = true,
                                       .aim = true,
                                       .sharing = false,
                                       .threads = 2})
        .choice;
  };
  const Vec3 at_the_ball{0, -0.3f, -0.5f}, beside_it{3, 3, -0.5f};
  for (const std::uint32_t samples : {kFewSamples, 4096u}) {
    EXPECT_EQ(choose(at_the_ball, samples).direction, Direction::kBoth);
    EXPECT_GT(choose(at_the_ball, samples).aimed, 0.0f);
  }
  EXPECT_EQ(choose(beside_it, 4096).direction, Direction::kBoth);
  // A part that goes astray is so small that it hardly costs anything.
  EXPECT_LT(choose(beside_it, 4096).aimed, 0.9f);
}

TEST(Pilot, TracesNoForwardPhotonsWithoutMirrorsAndGlass) {
  test::SceneBuilder builder = test::floor_and_lamp(false);
  builder.message.mutable_tracing()->set_direction(v1::DIRECTION_BOTH);
  const PilotResult found = pilot(builder, true);
  EXPECT_EQ(found.choice.direction, Direction::kAdjoint);
  EXPECT_TRUE(std::ranges::all_of(
      found.tried, [](const PilotFigures& f) { return f.kind.from == PhotonKind::kSensor; }));
}

TEST(Pilot, FindsTheSameForAnyNumberOfThreadsAndLeavesTheScene) {
  const auto scene = lit_by_its_ceiling().load();
  const auto ask = [&](unsigned threads) {
    return run_pilot(*scene, {.film = {64, 48},
                              .samples = 1024,
                              .direction = false,
                              .aim = false,
                              .sharing = true,
                              .threads = threads});
  };
  const PilotResult one = ask(1), three = ask(3);
  ASSERT_EQ(one.tried.size(), three.tried.size());
  for (std::size_t i = 0; i < one.tried.size(); ++i) {
    EXPECT_EQ(one.tried[i].relative_mse, three.tried[i].relative_mse);
    EXPECT_EQ(one.tried[i].cost, three.tried[i].cost);
  }
  EXPECT_EQ(scene->options.sharing, 1u);
  EXPECT_EQ(scene->options.seed, 0u);
}

TEST(Pilot, TakesASmallPartOfTheRender) {
  constexpr std::uint32_t kSamples = 16384;
  const PilotResult found = pilot(lit_by_its_ceiling(), false, kSamples);
  EXPECT_LT(static_cast<double>(found.photons), 0.03 * 64 * 48 * kSamples);
}

TEST(Pilot, TakesWhatTellsFromASmallRenderButNoMoreThanASecond) {
  // A fifth, and those that told how many rays that is.
  EXPECT_LT(pilot(lit_by_its_ceiling(), false, kFewSamples).photons, 64 * 48 * kFewSamples / 4);
  // Photons that are reflected thirty times: two million rays at most.
  const PilotResult found = pilot(lit_by_its_ceiling(0.98f), false, kFewSamples);
  EXPECT_LT(found.rays, 2'500'000u);
}

}  // namespace
}  // namespace nocturne

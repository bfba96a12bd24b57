// Which way a pilot chooses. That images are the same by all ways is for tests/accuracy. Long, as
// it has what each choice goes by beside the choices themselves.
#include "tracer/pilot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/caustic_scene.h"
#include "tracer/forward_pays.h"
#include "tracer/learn.h"
#include "tracer/rare_light.h"
#include "tracer/sharing_pays.h"

namespace nocturne {
namespace {

PilotFigures figures(double mean, double mean_error, double relative_mse, double cost = 1.0) {
  PilotFigures made{.photons = PilotFigures::kAdjoint,
                    .mean = mean,
                    .mean_error = mean_error,
                    .relative_mse = relative_mse,
                    .cost = cost};
  made.of_groups.fill(relative_mse / PilotFigures::kGroups);
  return made;
}

/// With all of its error in one group of pixels.
PilotFigures by_one_pixel(PilotFigures figures) {
  figures.of_groups.fill(1e-3 * figures.relative_mse);
  figures.of_groups[3] = figures.relative_mse;
  return figures;
}

TEST(PilotFigures, TellHowUncertainARatioIs) {
  GroupErrors even{}, uneven{};
  even.fill(1.0);
  for (std::size_t i = 0; i < uneven.size(); ++i) uneven[i] = i % 2 == 0 ? 0.9 : 1.1;
  EXPECT_EQ(error_of_log_ratio(even, even), 0.0);
  // Of a mean of 16 numbers that are 0.9 or 1.1: their standard deviation with 15 degrees of
  // freedom, over 4.
  EXPECT_NEAR(error_of_log_ratio(uneven, even), std::sqrt(0.01 * 16 / 15) / 4, 1e-4);
  const PilotFigures one = by_one_pixel(figures(1, 1, 1));
  EXPECT_GT(error_of_log_ratio(one.of_groups, even), 3.0);
  GroupErrors alone{};
  alone[0] = 1.0;
  EXPECT_EQ(error_of_log_ratio(alone, even), std::numeric_limits<double>::infinity());
}

TEST(PilotOfGuides, LeavesToChanceWhatFewPixelsSay) {
  const PilotFigures before = figures(1, 0.1, 4.0), better = figures(1, 0.1, 1.0);
  EXPECT_TRUE(guide_pays(before, better));
  EXPECT_FALSE(guide_pays(by_one_pixel(before), better));
  // What one group of 16 has does not hide a gain of a hundred.
  EXPECT_TRUE(guide_pays(figures(1, 0.1, 400.0), better));
}

TEST(PilotOfGuides, NeverTakesWhatLosesLight) {
  EXPECT_TRUE(guide_loses_light(figures(1.0, 0.01, 4.0), figures(0.9, 0.01, 1.0)));
  EXPECT_FALSE(guide_pays(figures(1.0, 0.01, 4.0), figures(0.9, 0.01, 1.0)));
  EXPECT_FALSE(guide_loses_light(figures(1.0, 0.01, 4.0), figures(0.99, 0.01, 1.0)));
}

TEST(PilotOfSharing, TellsThatMeansDiffer) {
  const std::vector<double> alone{1, 2, 1, 2, 1, 2, 1, 2};
  std::vector<double> shared = alone, noisy = alone;
  for (std::size_t i = 0; i < alone.size(); ++i) {
    shared[i] *= 1.4;
    noisy[i] += i == 0 ? 4.8 : 0.0;
  }
  EXPECT_NEAR(means_differ(alone, shared), 0.4, 1e-12);
  EXPECT_EQ(means_differ(alone, alone), 0.0);
  // The same light more in one square alone is chance.
  EXPECT_EQ(means_differ(alone, noisy), 0.0);
  EXPECT_EQ(means_differ({alone.begin(), 5}, {shared.begin(), 5}), 0.0);
}

TEST(PilotOfRareLight, IsBroughtWhereOthersMissIt) {
  EXPECT_TRUE(must_be_brought({{2.0, 0.1}, {0.0, 0.0}}, 365.0));
  EXPECT_TRUE(must_be_brought({{2.0, 0.8}, {0.0, 0.0}}, 365.0));
  EXPECT_FALSE(must_be_brought({{2.0, 1.2}, {0.0, 0.0}}, 365.0));
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

const PilotFigures kNone{.photons = PilotFigures::kAdjointOfBoth};

TEST(PilotOfBoth, WhereItHasLessErrorForTheSameCost) {
  const PilotFigures adjoint = figures(10, 1, 4.0);
  EXPECT_EQ(forward_pays({adjoint, adjoint, kNone, adjoint}, figures(10, 0.1, 1.0, 2.0)),
            ForwardPays::kLessError);
  EXPECT_EQ(forward_pays({adjoint, adjoint, kNone, adjoint}, figures(10, 0.1, 1.0, 4.0)),
            ForwardPays::kNot);
  // The rest's error and cost count, too.
  EXPECT_EQ(forward_pays({adjoint, adjoint, figures(5, 0.1, 3.0), figures(5, 1, 1)},
                         figures(5, 0.1, 0.1)),
            ForwardPays::kNot);
}

TEST(PilotOfBoth, NotWhereItHasFoundNothingOrHardlyAnything) {
  const PilotFigures adjoint = figures(10, 5, 400.0);
  EXPECT_EQ(forward_pays({adjoint, adjoint, kNone, adjoint}, figures(0, 0, 0)), ForwardPays::kNot);
  EXPECT_EQ(forward_pays({adjoint, adjoint, kNone, adjoint}, figures(10, 4, 0.01)),
            ForwardPays::kNot);
}

// A way that misses light has little noise.
TEST(PilotOfBoth, NotWhereItMissesWhatTheOtherFinds) {
  EXPECT_EQ(
      forward_pays({figures(10, 0.1, 4.0), figures(10, 0.1, 4.0), kNone, figures(10, 0.1, 4.0)},
                   figures(5, 0.1, 0.01)),
      ForwardPays::kNot);
}

TEST(PilotOfBoth, WhereTheOtherMissesWhatItFinds) {
  EXPECT_EQ(
      forward_pays({figures(5, 0.1, 0.01), figures(5, 0.1, 0.01), kNone, figures(5, 0.1, 0.01)},
                   figures(10, 0.1, 4.0)),
      ForwardPays::kFindsMore);
}

TEST(PilotOfBoth, WhereTheOtherHasFoundNothingAtAllOfWhatAFewFound) {
  const PilotFigures adjoint = figures(10, 0.1, 0.1), nothing = figures(0, 0, 0);
  EXPECT_EQ(forward_pays({adjoint, adjoint, adjoint, nothing}, figures(1, 0.4, 500.0)),
            ForwardPays::kFindsMore);
  EXPECT_EQ(forward_pays({adjoint, adjoint, adjoint, nothing}, figures(1, 0.7, 500.0)),
            ForwardPays::kNot);
  EXPECT_EQ(
      forward_pays({adjoint, adjoint, adjoint, figures(0.1, 0.1, 1.0)}, figures(1, 0.4, 500.0)),
      ForwardPays::kNot);
}

// Costs and errors of two that share the time: the best parts are as the roots of error over cost.
TEST(PilotOfBoth, GivesEachKindAsManyPhotonsAsPay) {
  const auto ratio = [](double adjoint_mse, double forward_mse, double forward_cost) {
    return best_forward_ratio(figures(1, 1, adjoint_mse), figures(1, 1, forward_mse, forward_cost));
  };
  EXPECT_EQ(ratio(1.0, 1.0, 1.0), 1.0);
  EXPECT_EQ(ratio(1.0, 16.0, 1.0), 4.0);
  EXPECT_EQ(ratio(16.0, 1.0, 1.0), 0.25);
  EXPECT_EQ(ratio(1.0, 16.0, 0.25), 8.0);
  // Each keeps a sixteenth of the time: at a ratio of 8 a ninth.
  EXPECT_EQ(ratio(0.0, 1.0, 1.0), 8.0);
  EXPECT_EQ(ratio(1.0, 0.0, 1.0), 0.125);
  // Hardly better: as it was.
  EXPECT_EQ(ratio(1.0, 1.5, 1.0), 1.0);
}

TEST(PilotOfBoth, MayBeWorthItByTheirRatioAlone) {
  const PilotFigures adjoint = figures(10, 1, 4.0), rest = figures(5, 0.1, 0.01),
                     left = figures(5, 1, 4.0), forward = figures(5, 0.1, 2.0);
  EXPECT_EQ(forward_pays({adjoint, adjoint, rest, left}, forward), ForwardPays::kNot);
  EXPECT_EQ(forward_pays({adjoint, adjoint, rest, left}, forward, 4.0), ForwardPays::kLessError);
}

TEST(PilotOfBoth, TakesThePartOfAimedPhotonsThatIsBest) {
  const AdjointFigures adjoint{figures(10, 1, 4.0), figures(10, 1, 4.0), figures(5, 0.1, 0.5),
                               figures(5, 1, 3.5)};
  const std::vector<PilotFigures> of_aims{figures(5, 0.1, 0.5), figures(5, 0.1, 0.1),
                                          figures(5, 0.1, 9.0)};
  const auto choose = [&](double worth_it) {
    return choose_forward_photons(adjoint, of_aims, 1.0, worth_it);
  };
  EXPECT_EQ(choose(kWorthIt).forward, &of_aims[1]);
  EXPECT_DOUBLE_EQ(choose(kWorthIt).gain, 4.0 / (0.6 * 2.0));
  EXPECT_FALSE(choose(kWorthIt).finds_more);
  // What is gained is told even where none pay.
  EXPECT_EQ(choose(4.0).forward, nullptr);
  EXPECT_DOUBLE_EQ(choose(4.0).most_gain, 4.0 / (0.6 * 2.0));
}

TEST(PilotOfBoth, GuidesWhereThatFindsMoreOrHasMuchLessError) {
  EXPECT_TRUE(guide_pays(figures(5, 0.1, 1.0), figures(6, 0.1, 9.0)));
  EXPECT_FALSE(guide_finds_more(figures(5, 1, 1.0), figures(6, 1, 9.0)));
  EXPECT_TRUE(guide_pays(figures(5, 1, 9.0), figures(5, 1, 1.0)));
  // A pool whose lamp the others hardly ever meet; and one that the guided ones met once.
  EXPECT_TRUE(guide_finds_more(figures(311, 83, 411.0), figures(32617, 13649, 1e8)));
  EXPECT_FALSE(guide_finds_more(figures(311, 83, 411.0), figures(32617, 32000, 1e8)));
  EXPECT_FALSE(guide_pays(figures(5, 1, 1.1), figures(5, 1, 1.0)));
}

TEST(PilotOfBoth, SendsAdjointPhotonsTowardsImportantShapesWhereTheyPay) {
  // The reflector and the headlight of the examples.
  EXPECT_FALSE(hints_pay(figures(0.3, 0.01, 0.03), figures(0.3, 0.01, 0.004)));
  EXPECT_FALSE(hints_pay(figures(0.0122, 0.0025, 0.0017), figures(0.0114, 0.0011, 0.0006)));
  EXPECT_TRUE(hints_pay(figures(5, 0.1, 1.0), figures(5, 0.3, 9.0)));
  // What is cheaper may have more error.
  EXPECT_FALSE(hints_pay(figures(5, 0.1, 1.0, 2.0), figures(5, 0.1, 1.5, 1.0)));
  // Without them light may be missing, which looks good.
  EXPECT_TRUE(hints_pay(figures(5, 1, 9.0), figures(2, 0.1, 0.1)));
}

// What parts of films gained as pilots measured them (docs/decisions/0062).
TEST(PilotOfSharing, PaysWhereMostPartsGain) {
  EXPECT_EQ(sharing_pays({4.36, 2.24, 4.26, 3.55}, 1.25), 3.55);          // a Cornell box
  EXPECT_EQ(sharing_pays({3.55, 1.02, 2.74, 5.22, 1.98}, 1.25), 2.74);    // a polished floor
  EXPECT_EQ(sharing_pays({0.23, 0.33, 0.27, 0.24}, 1.25), std::nullopt);  // a colour chart
  EXPECT_EQ(sharing_pays({1.84, 2.13, 0.82, 1.95, 3.62}, 2.0), std::nullopt);
  EXPECT_EQ(sharing_pays({}, 1.25), std::nullopt);
}

// Glossy spheres under a small Sun, where it loses by references.
TEST(PilotOfSharing, NotWhereItLosesMoreInSomePartsThanItGainsInMost) {
  EXPECT_EQ(sharing_pays({0.11, 1.33, 6.98, 1.96}, 1.25), std::nullopt);
  EXPECT_EQ(sharing_pays({0.14, 0.50, 3.72, 1.30, 7.53}, 1.25), std::nullopt);
  EXPECT_EQ(sharing_pays({1.54, 1.47, 0.41, 2.48, 0.81}, 1.25), std::nullopt);
}

TEST(PilotOfSharing, IsPlainWhereOnePartMoreWouldNotMatter) {
  EXPECT_TRUE(votes_are_plain(std::vector{4.36, 1.24, 4.26, 3.55}, 1.25));
  EXPECT_TRUE(votes_are_plain(std::vector{0.23, 9.0, 0.27, 0.24}, 1.25));
  // Or what one loses outweighs what the others gain.
  EXPECT_FALSE(votes_are_plain(std::vector{1.84, 1.84, 0.1, 1.84, 1.84}, 1.25));
  EXPECT_FALSE(votes_are_plain(std::vector{0.66, 1.34, 1.79, 0.50, 0.29}, 1.25));
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

// Photons that are not guided only ask whether the way to the lamp is free, of directions that what
// was learned has no part in; guided ones that asked so looked a fifth too bright.
TEST(Pilot, ComparesGuidedPhotonsThatFindTheSameLight) {
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
  ASSERT_TRUE(scene->occlusion_decides);
  const Learned learned = learn(*scene, {64, 48}, 1 << 18, 2);
  ASSERT_GT(learned.arrivals.size(), 1000u);
  scene->lights.set_learned(LearnedLight(learned.arrivals));
  const PilotResult found = run_pilot(*scene, {.film = {64, 48},
                                               .samples = 16384,
                                               .direction = true,
                                               .aim = false,
                                               .sharing = false,
                                               .guide = true,
                                               .threads = 2});
  ASSERT_GE(found.tried.size(), 2u);
  const PilotFigures &alone = found.tried[0], &guided = found.tried[1];
  ASSERT_TRUE(guided.guided);
  EXPECT_NEAR(guided.mean, alone.mean, 4.0 * std::hypot(alone.mean_error, guided.mean_error));
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

TEST(Pilot, SendsNoAdjointPhotonsTowardsWhatBringsThemNothing) {
  test::SceneBuilder builder = test::floor_and_lamp(true);
  add_important_ball(builder, {3, 3, -0.5f}, 0.4);
  v1::Tracing& tracing = *builder.message.mutable_tracing();
  tracing.set_weight_kernel(0.4);
  tracing.set_weight_luminaires(0.3);
  tracing.set_weight_important(0.3);
  tracing.set_weight_uniform(0.0);
  const auto scene = builder.load();
  PilotRequest request{.film = {64, 48},
                       .samples = 4096,
                       .direction = true,
                       .aim = false,
                       .sharing = false,
                       .hint = true,
                       .threads = 2};
  const PilotChoice choice = run_pilot(*scene, request).choice;
  EXPECT_EQ(choice.direction, Direction::kBoth);
  EXPECT_FALSE(choice.hinted);
  // The scene is what it was.
  request.hint = false;
  EXPECT_TRUE(run_pilot(*scene, request).choice.hinted);
  const LightSamplingContext floor{{0, -1, 0}, {0, 1, 0}};
  EXPECT_GT(scene->lights.pdf(floor, normalized({3, 4, -0.5f})), 0.0f);
}

TEST(Pilot, TracesNoForwardPhotonsWithoutMirrorsAndGlass) {
  test::SceneBuilder builder = test::floor_and_lamp(false);
  builder.message.mutable_tracing()->set_direction(v1::DIRECTION_BOTH);
  const PilotResult found = pilot(builder, true);
  EXPECT_EQ(found.choice.direction, Direction::kAdjoint);
  EXPECT_TRUE(std::ranges::all_of(
      found.tried, [](const PilotFigures& f) { return f.photons == PilotFigures::kSharing; }));
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
  for (const std::uint32_t samples : {1024u, 16384u}) {
    const PilotResult found = run_pilot(*lit_by_its_ceiling().load(), {.film = {64, 48},
                                                                       .samples = samples,
                                                                       .direction = false,
                                                                       .aim = false,
                                                                       .sharing = true,
                                                                       .threads = 2});
    EXPECT_LT(static_cast<double>(found.photons), 0.03 * 64 * 48 * samples);
  }
}

TEST(Pilot, TakesWhatTellsFromASmallRenderButNoMoreThanASecond) {
  EXPECT_LT(pilot(lit_by_its_ceiling(), false, kFewSamples).photons, 60'000u);
  // Photons that are reflected thirty times: half a million rays, and those that told so.
  const PilotResult found = pilot(lit_by_its_ceiling(0.98f), false, kFewSamples);
  EXPECT_LT(found.rays, 1'000'000u);
}

}  // namespace
}  // namespace nocturne

// Tracing ends when it is asked to, and paths that would not end by themselves end and are counted.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "support/caustic_scene.h"
#include "support/scene_builder.h"
#include "tracer/media/delta_tracking.h"
#include "tracer/pilot/pilot_budget.h"
#include "tracer/trace_tile.h"

namespace nocturne {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

// A million collisions per metre, none of which absorbs: nothing ever comes out.
std::shared_ptr<Scene> fog_without_end() {
  test::SceneBuilder builder;
  builder.look({0, 0, 0.5f}, {0, 0, 0}, 0.6);
  builder.add_quad(0.5f, 1.0f, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  builder.add_unbounded(
      {builder.add_medium(builder.add_spectrum(0.0f), builder.add_spectrum(1e6f), 0.0)});
  // As the compiler has it: roulette ends nobody who carries as much as at the start.
  auto& tracing = *builder.message.mutable_tracing();
  tracing.set_maximum_depth(0);
  tracing.set_estimator(v1::ESTIMATOR_TWO_PHOTONS);
  tracing.set_h(4);
  return builder.load();
}

TEST(Stopping, TracingEndsSoonAfterItIsAsked) {
  const auto scene = fog_without_end();
  std::stop_source source;
  Clock::time_point asked;
  std::jthread asks([&] {
    std::this_thread::sleep_for(milliseconds(200));
    asked = Clock::now();
    source.request_stop();
  });
  EXPECT_THROW(
      trace_tile(*scene, {32, 32}, {0, 0, 32, 32, 0, 4096}, kBatchGroups, source.get_token()),
      TracingStopped);
  const auto ended = Clock::now();
  asks.join();
  EXPECT_LT(ended - asked, milliseconds(500));
}

TEST(Stopping, PathsBeyondTheLimitEndAndAreCounted) {
  const auto scene = fog_without_end();
  const TileSums sums = trace_tile(*scene, {1, 1}, {0, 0, 1, 1, 0, 1});
  EXPECT_GE(sums.truncated_paths, scene->options.group);
  EXPECT_EQ(sums.invalid_samples, 0U);
  EXPECT_GE(sums.rays, PathLimits::kMaxRays);
  EXPECT_TRUE(std::isfinite(sums.sums[1]));
}

// Before anything is learned or compared, which takes thousands of samples.
TEST(Stopping, NoPilotIsMadeOfPathsThatDoNotEnd) {
  EXPECT_THROW(check_that_samples_end(*fog_without_end(), {2, 1}, 1), std::runtime_error);
  check_that_samples_end(*test::floor_and_lamp(true).load(), {64, 48}, 2);
}

// Nowhere dense, though it might be dense anywhere: all collisions are null collisions.
struct NothingBelowAMajorant {
  struct Majorants {
    Majorants(const NothingBelowAMajorant&, const Ray&, float far) : end(far) {}
    bool next(MajorantSegment& segment) {
      segment = {end, 1.0f};
      return !std::exchange(given, true);
    }
    float density(float) const { return 0.0f; }
    float end;
    bool given = false;
  };
};

constexpr Ray kAlongX{{0, 0, 0}, {1, 0, 0}};

TEST(Stopping, FlightHasABoundOfTentativeCollisions) {
  const PathLimits limits(std::stop_token{});
  FlightNumbers numbers(1);
  std::uint32_t tried = 0;
  EXPECT_FALSE(for_each_tentative(NothingBelowAMajorant(), 1e9f, kAlongX, 1e3f, numbers, limits,
                                  [&](const Tentative&) { return ++tried > 0; }));
  EXPECT_EQ(tried, PathLimits::kMaxTentative);
}

TEST(Stopping, FlightStopsInMidMedium) {
  std::stop_source source;
  source.request_stop();
  const PathLimits limits(source.get_token());
  FlightNumbers numbers(1);
  std::uint32_t tried = 0;
  EXPECT_THROW(for_each_tentative(NothingBelowAMajorant(), 1e9f, kAlongX, 1e3f, numbers, limits,
                                  [&](const Tentative&) { return ++tried > 0; }),
               TracingStopped);
  EXPECT_EQ(tried, PathLimits::kTentativeUnwatched);
}

}  // namespace
}  // namespace nocturne

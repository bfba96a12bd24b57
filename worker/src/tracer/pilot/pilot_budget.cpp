#include "tracer/pilot/pilot_budget.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace nocturne {
namespace {

/// Part of the render's rays that a pilot takes including those it learned from, and the most of
/// them; and part of a small render's, between the least that is informative and a matter of a
/// second.
constexpr double kPart = 0.024, kMostRays = 12e6;
constexpr double kPartOfSmall = 0.2, kLeastRays = 0.25e6, kEnoughRays = 2e6;
/// Samples of each of so many pixels by which the rays of a sample are counted.
constexpr std::uint32_t kPixels = 256, kSamples = 16;
/// The same for half of so many pixels' first samples: a pilot's thousands would be 10^8 and more.
constexpr std::uint64_t kMostRaysOfSample = 1 << 14;
constexpr std::uint32_t kFirst = 12;

}  // namespace

void check_that_samples_end(Scene& scene, Film film, unsigned threads) {
  Trials trials(scene, film, threads);
  // Each vertex takes a ray at least. `trials` gives the options back.
  constexpr auto kEnough = static_cast<std::uint32_t>(2 * kMostRaysOfSample);
  scene.options.max_depth = std::min(scene.options.max_depth, kEnough);
  const PilotImages made = trials.images({}, film, trials.some_squares(kFirst, 1, 1), 1);
  std::vector<std::uint64_t> rays;
  for (const TileSums& sums : made.images.front()) rays.push_back(sums.rays);
  const auto middle = rays.begin() + static_cast<std::ptrdiff_t>(rays.size() / 2);
  std::ranges::nth_element(rays, middle);
  if (*middle > kMostRaysOfSample) {
    throw std::runtime_error("half of the samples take more than " +
                             std::to_string(kMostRaysOfSample) + " rays, too many for a pilot");
  }
}

PilotBudget pilot_budget(Trials& trials, const PilotRequest& request) {
  const Film film = trials.reduced(kPixels);
  const PilotImages probe = trials.images({}, film, whole(film, kSamples), 1);
  const double rays = std::max(1.0, rays_of(probe) / (pixels_of(film) * kSamples));
  const double all = rays * pixels_of(request.film) * request.samples;
  const double of_small = std::clamp(kPartOfSmall * all, kLeastRays, kEnoughRays);
  const double part = std::max(kPart * all, of_small);
  return {.samples = std::max(0.0, std::min(part, kMostRays) / rays - request.training_samples),
          .mean = means_of_images(probe)[0]};
}

}  // namespace nocturne

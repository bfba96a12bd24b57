#include "tracer/learning/learn_visible_sky.h"

#include <algorithm>
#include <cmath>

#include "tracer/by_threads.h"
#include "tracer/estimators/radiance_estimator.h"
#include "tracer/trace_tile.h"

namespace nocturne {
namespace {

/// Part of the photons towards lights that no surface stops, from which on the sky is open: knowing
/// the visible part could bring a factor of two at most. In the living room of bench/real it is
/// 0.04.
constexpr double kOpen = 0.3;

}  // namespace

LearnedSky learn_visible_sky(Scene& scene, Film film, double samples, unsigned threads) {
  if (!scene.lights.environment()) return {};
  const TracingOptions before = scene.options;
  const bool occlusion = scene.shadow_rays_suffice;
  scene.options.direction = Direction::kAdjoint;
  scene.options.sharing = 1;
  scene.options.seed = ~before.seed;
  // Photons that fly towards lights tell what they meet.
  scene.shadow_rays_suffice = false;
  const double of_line = static_cast<double>(film.width);
  const auto count = static_cast<std::uint32_t>(
      std::clamp(samples / of_line, 1.0, static_cast<double>(film.height)));
  const auto each =
      static_cast<std::uint32_t>(std::max(1.0, std::round(samples / (of_line * count))));
  std::vector<SkySightings> lines(count);
  by_threads(count, threads, [&](std::size_t i) {
    const auto y = static_cast<std::uint32_t>((static_cast<double>(i) + 0.5) * film.height / count);
    trace_tile(scene, film, {0, y, film.width, 1, 0, each}, kBatchGroups, {}, &lines[i]);
  });
  scene.options = before;
  scene.shadow_rays_suffice = occlusion;
  LearnedSky found;
  std::vector<VisibleSky::Sighting> all;
  double free = 0.0, stopped = 0.0;
  for (const SkySightings& line : lines) {
    all.insert(all.end(), line.all.begin(), line.all.end());
    free += static_cast<double>(line.free);
    stopped += static_cast<double>(line.stopped);
  }
  found.samples = std::uint64_t{count} * film.width * each;
  if (free > kOpen * (free + stopped)) return found;
  const std::size_t step = all.size() / VisibleSky::kMaxSightings + 1;
  for (std::size_t i = 0; i < all.size(); i += step) found.sightings.push_back(all[i]);
  return found;
}

}  // namespace nocturne

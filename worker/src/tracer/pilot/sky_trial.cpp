#include "tracer/pilot/sky_trial.h"

#include <utility>
#include <vector>

#include "math/functions.h"
#include "tracer/pilot/trials.h"

namespace nocturne {
namespace {

/// Of a pixel in each image, as in a pilot's first round.
constexpr std::uint32_t kSamples = 16;

}  // namespace

SkyTrial try_visible_sky(Scene& scene, VisibleSky sky, Film film, double samples,
                         unsigned threads) {
  Trials trials(scene, film, threads);
  const Film small = trials.reduced(samples / (2.0 * Trials::kImages * kSamples));
  const PhotonKind kind;
  scene.lights.set_visible_sky({});
  const PilotImages without = trials.images(kind, small, whole(small, kSamples));
  scene.lights.set_visible_sky(std::move(sky));
  const PilotImages with = trials.images(kind, small, whole(small, kSamples));
  PilotImages both = without;
  extend(both, with);
  std::vector<double> light;
  for (const PixelLight& each : light_of_pixels(both)) light.push_back(each.mean);
  const std::vector<double> shown = light_around(light, both);
  const PilotFigures plain = figures_of(kind, without, shown, 1.0),
                     knowing = figures_of(kind, with, shown, 1.0);
  const double gain = plain.relative_mse * plain.cost / (knowing.relative_mse * knowing.cost);
  const double error = error_of_log_ratio(plain.of_groups, knowing.of_groups);
  SkyTrial trial{.pays = math::log(gain) > error,
                 .samples = trials.photons() / scene.options.group};
  if (!trial.pays) scene.lights.set_visible_sky({});
  return trial;
}

}  // namespace nocturne

#include "tracer/pilot/rare_light.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "math/functions.h"
#include "tracer/pilot/compare_methods.h"

namespace nocturne {
namespace {

/// Light is rare where one hit is at least this part of the mean.
constexpr double kOneFind = 1e-4;
/// Photons from the sensor whose error is so many times larger meet the light in finds so rare that
/// an image's errors don't show them; where it is less, both directions are about as sure.
constexpr double kMuchLessCertain = 2.0;
/// Where photons from the sensor found nothing at all of the light, others are certain of it that
/// are some four of each image.
constexpr double kSeen = 2.0;
/// And so many standard errors show that these miss light; where chance alone says so, both
/// directions are right as well.
constexpr double kRareMissed = 2.5;

bool is_unseen(const MeanLight& light) { return light.mean == 0.0 && light.error == 0.0; }

bool is_certain(const RareLight& light) {
  const auto& [forward, adjoint] = light;
  return forward.mean > 0.0 && forward.mean >= (is_unseen(adjoint) ? kSeen : kSure) * forward.error;
}

/// How much more light photons from luminaires may bring than those from the sensor met of the same
/// kind, in parts of the mean; 0 where their mean is certain enough to be compared, or they found
/// nothing.
double may_be_unmet(const MeanLight& by_luminaires, const MeanLight& met, double mean) {
  const auto [found, error] = by_luminaires;
  if (found >= kSure * error || !(found > 0.0 && mean > 0.0)) return 0.0;
  return std::max(0.0, found + kStandardErrors * error - met.mean) / mean;
}

/// Empty where nothing shines so brightly.
std::optional<RareLight> find_rare_light(Scene& scene, Trials& trials, const PhotonKind& luminaires,
                                         const PhotonKind& sensor, Film film, std::uint32_t samples,
                                         float radiance) {
  if (!(radiance > 0.0f)) return std::nullopt;
  const float before = std::exchange(scene.options.least_radiance, radiance);
  const auto met = [&](const PhotonKind& kind) {
    return trials.images(kind, film, whole(film, samples));
  };
  std::optional<RareLight> light;
  const PilotImages forward = met(luminaires);
  if (rays_of(forward) > 0.0) {
    light.emplace().by_forward = mean_and_error(forward);
    if (light->by_forward.mean > 0.0) {
      PilotImages left = met(sensor);
      // By the same numbers, so that what both have in common is none of the difference.
      PhotonKind of_both = sensor;
      of_both.from = PhotonKind::kSensorOfBoth;
      if (trials.given().direction == Direction::kBoth) subtract(left, met(of_both));
      light->by_adjoint = mean_and_error(left);
    }
  }
  scene.options.least_radiance = before;
  return light;
}

}  // namespace

bool must_be_brought(const RareLight& light, double mean) {
  const auto& [forward, adjoint] = light;
  // Light that photons from a luminaire found is there, however few they were.
  if (is_unseen(adjoint)) return forward.mean > kCounts * mean;
  const double more = forward.mean - adjoint.mean;
  const bool differ = more > kRareMissed * math::hypot(forward.error, adjoint.error);
  const bool less_certain = adjoint.error > kMuchLessCertain * forward.error;
  return (differ && more > kCounts * mean) ||
         (is_certain(light) && less_certain && forward.mean > kCounts * mean);
}

double may_be_missing(const RareLight& light, double mean) {
  const auto& [forward, adjoint] = light;
  const double more = forward.mean - adjoint.mean;
  const bool differ = more > kStandardErrors * math::hypot(forward.error, adjoint.error);
  if (!(mean > 0.0 && forward.mean > 0.0) || (is_certain(light) && !differ)) return 0.0;
  return std::max(0.0, more + kStandardErrors * forward.error) / mean;
}

float rare_radiance(double mean, double samples) {
  return static_cast<float>(std::min(kOneFind * mean * samples / kLuminanceOfOne,
                                     static_cast<double>(std::numeric_limits<float>::max())));
}

RareLightTrial try_rare_light(Scene& scene, Trials& trials, const std::vector<PilotMethod>& methods,
                              const PhotonKind& sensor, const ImagesOfKind& images, Film film,
                              std::uint32_t samples, float rare, double mean) {
  const PilotMethod method = surest_from_luminaires(methods, sensor, images);
  const PilotImages& brought = images(*method.luminaires);
  PilotImages left = images(sensor);
  if (method.sensor) subtract(left, images(*method.sensor));
  const double unmet = may_be_unmet(mean_and_error(brought), mean_and_error(left), mean);
  const auto light =
      find_rare_light(scene, trials, *method.luminaires, sensor, film, samples, rare);
  if (!light) return {.unmet = unmet, .bring_it = {}};
  if (!must_be_brought(*light, mean)) {
    return {.unmet = std::max(unmet, may_be_missing(*light, mean)), .bring_it = {}};
  }
  RareLightTrial trial{.unmet = 0.0, .bring_it = methods};
  std::erase_if(trial.bring_it,
                [&](const PilotMethod& each) { return each.luminaires != method.luminaires; });
  return trial;
}

}  // namespace nocturne

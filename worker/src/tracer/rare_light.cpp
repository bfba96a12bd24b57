#include "tracer/rare_light.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "math/functions.h"

namespace nocturne {
namespace {

/// Part of the mean that one find is, from which light is rare; and part that counts where it is
/// missing: a tenth of what most renders are asked for.
constexpr double kOneFind = 1e-4, kCounts = 1e-3;
/// Photons from the sensor whose error is so many times larger meet the light in finds so rare that
/// an image's errors don't tell of them; where it is less, both directions are about as sure.
constexpr double kMuchLessCertain = 2.0;
/// Where photons from the sensor found nothing at all of the light, others are certain of it that
/// are some four of each image.
constexpr double kSeen = 2.0;
/// And so many standard errors show that these miss light; where chance alone says so, both
/// directions are right as well.
constexpr double kRareMissed = 2.5;

bool is_unseen(const MeanLight& light) { return light.mean == 0.0 && light.error == 0.0; }

bool is_certain(const RareLight& light) {
  const auto& [other, best] = light;
  return other.mean > 0.0 && other.mean >= (is_unseen(best) ? kSeen : kSure) * other.error;
}

}  // namespace

bool must_be_brought(const RareLight& light, double mean) {
  const auto& [other, best] = light;
  // Light that photons from a luminaire found is there, however few they were.
  if (is_unseen(best)) return other.mean > kCounts * mean;
  const double more = other.mean - best.mean;
  const bool differ = more > kRareMissed * math::hypot(other.error, best.error);
  const bool less_certain = best.error > kMuchLessCertain * other.error;
  return (differ && more > kCounts * mean) ||
         (is_certain(light) && less_certain && other.mean > kCounts * mean);
}

double may_be_missing(const RareLight& light, double mean) {
  const auto& [other, best] = light;
  const double more = other.mean - best.mean;
  const bool differ = more > kStandardErrors * math::hypot(other.error, best.error);
  if (!(mean > 0.0 && other.mean > 0.0) || (is_certain(light) && !differ)) return 0.0;
  return std::max(0.0, more + kStandardErrors * other.error) / mean;
}

double may_be_unmet(const MeanLight& by_luminaires, const MeanLight& met, double mean) {
  const auto [found, error] = by_luminaires;
  if (found >= kSure * error || !(found > 0.0 && mean > 0.0)) return 0.0;
  return std::max(0.0, found + kStandardErrors * error - met.mean) / mean;
}

float rare_radiance(double mean, double samples) {
  return static_cast<float>(std::min(kOneFind * mean * samples / kLuminanceOfOne,
                                     static_cast<double>(std::numeric_limits<float>::max())));
}

PilotImages rare_light_by(const PhotonKind& kind, Scene& scene, Trials& trials, Film film,
                          std::uint32_t samples, float radiance) {
  const float before = std::exchange(scene.options.least_radiance, radiance);
  PilotImages images = trials.images(kind, film, whole(film, samples));
  scene.options.least_radiance = before;
  return images;
}

std::optional<RareLight> find_rare_light(Scene& scene, Trials& trials, const PhotonKind& luminaires,
                                         const PhotonKind& sensor, Film film, std::uint32_t samples,
                                         float radiance) {
  if (!(radiance > 0.0f)) return std::nullopt;
  const auto met = [&](const PhotonKind& kind) {
    return rare_light_by(kind, scene, trials, film, samples, radiance);
  };
  const PilotImages forward = met(luminaires);
  if (!(rays_of(forward) > 0.0)) return std::nullopt;
  RareLight light{.by_other = mean_and_error(forward), .by_best = {}};
  if (!(light.by_other.mean > 0.0)) return light;
  PilotImages left = met(sensor);
  // By the same numbers, so that what both have in common is none of the difference.
  PhotonKind of_both = sensor;
  of_both.from = PhotonKind::kSensorOfBoth;
  if (trials.given().direction == Direction::kBoth) subtract(left, met(of_both));
  light.by_best = mean_and_error(left);
  return light;
}

}  // namespace nocturne

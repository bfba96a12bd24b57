#include "tracer/rare_light.h"

#include <algorithm>
#include <limits>

#include "math/functions.h"
#include "tracer/forward_pays.h"

namespace nocturne {
namespace {

/// Part of the mean that one find is, from which light is rare; and part that counts where it is
/// missing: a tenth of what most renders are asked for.
constexpr double kOneFind = 1e-4, kCounts = 1e-3;
/// Photons from the sensor whose error is so many times larger meet the light in finds so rare that
/// an image's errors don't tell of them; where it is less, both directions are about as sure.
constexpr double kMuchLessCertain = 2.0;
/// Standard errors by which two means differ so far that it is told.
constexpr double kStandardErrors = 2.0;

bool is_unseen(const MeanLight& light) { return light.mean == 0.0 && light.error == 0.0; }

bool is_certain(const RareLight& light) {
  const auto& [forward, adjoint] = light;
  return forward.mean > 0.0 &&
         forward.error <= (is_unseen(adjoint) ? kSeen : kCertain) * forward.mean;
}

}  // namespace

bool must_be_brought(const RareLight& light, double mean) {
  const auto& [forward, adjoint] = light;
  const double more = forward.mean - adjoint.mean;
  const bool differ =
      is_unseen(adjoint) || more > kMissed * math::hypot(forward.error, adjoint.error);
  const bool less_certain = adjoint.error > kMuchLessCertain * forward.error;
  return is_certain(light) &&
         ((differ && more > kCounts * mean) || (less_certain && forward.mean > kCounts * mean));
}

double may_be_missing(const RareLight& light, double mean) {
  const auto& [forward, adjoint] = light;
  const double more = forward.mean - adjoint.mean;
  const bool differ = more > kStandardErrors * math::hypot(forward.error, adjoint.error);
  if (!(mean > 0.0 && forward.mean > 0.0) || (is_certain(light) && !differ)) return 0.0;
  return std::max(0.0, more + kAtMost * forward.error) / mean;
}

float rare_radiance(double mean, double samples) {
  return static_cast<float>(std::min(kOneFind * mean * samples / kLuminanceOfOne,
                                     static_cast<double>(std::numeric_limits<float>::max())));
}

std::optional<RareLight> find_rare_light(Scene& scene, Trials& trials, Direction direction,
                                         Film film, std::uint32_t samples, float radiance) {
  if (!(radiance > 0.0f)) return std::nullopt;
  const TracingOptions before = scene.options;
  scene.options.least_radiance = radiance;
  const auto square = whole(film, samples);
  const auto met = [&](Direction by, bool from_luminaires) {
    return trials.images(by, 1, film, square, Trials::kImages, from_luminaires);
  };
  std::optional<RareLight> light;
  const PilotImages forward = met(direction, true);
  if (rays_of(forward) > 0.0) {
    const auto [mean, error] = mean_and_error(forward);
    light.emplace().by_forward = {mean, error};
    if (mean > 0.0) {
      PilotImages left = met(Direction::kAdjoint, false);
      // By the same numbers, so that what both have in common is none of the difference.
      if (direction == Direction::kBoth) subtract(left, met(Direction::kBoth, false));
      const auto [of_adjoint, error_of_adjoint] = mean_and_error(left);
      light->by_adjoint = {of_adjoint, error_of_adjoint};
    }
  }
  scene.options = before;
  return light;
}

}  // namespace nocturne

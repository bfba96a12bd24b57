#include "tracer/pilot/unmet_parts.h"

#include <algorithm>
#include <cmath>

#include "tracer/pilot/rare_light.h"

namespace nocturne {
namespace {

/// Samples of a pilot's pixel in each image; where lamps are widened up to so many times as many,
/// so far as an image has no more than kEnough (milliseconds): on a ball of some pixels one photon
/// of hundreds meets a widened lamp, and where none does it looks as if there were nothing.
constexpr std::uint32_t kSamples = 16, kMoreTimes = 4;
constexpr double kEnough = 50e3;
/// Squares of so many pixels are read as one, whose error is reported.
constexpr double kSquare = 64.0;
/// From so many finds on the error of a mean can be relied on: of a Poisson number of 20 the usual
/// 95 % interval holds the truth 94 times of a hundred, of 5 it does 88 times.
constexpr double kFinds = 20.0;
/// Missing error of a square up to this part of the light seen there is not reported.
constexpr double kSmall = 0.02;
/// Part of a lamp's mean radiance that it has at any wavelength that counts.
constexpr float kDimWavelengths = 0.1f;
/// The light seen in dark parts next to bright ones counts as so much of the image's mean.
constexpr double kDark = 0.1;

std::vector<MeanLight> means_of_pixels(const PilotImages& images) {
  std::vector<MeanLight> means;
  for (const PixelLight& each : light_of_pixels(images)) {
    const auto count = static_cast<double>(images.images.size());
    means.push_back({each.mean, std::sqrt(each.variance / count)});
  }
  return means;
}

/// A pilot's pixel gives this about light that a square there finds by chance.
struct Chance {
  /// Of the square's mean, cd/m2 squared; and how many finds of one brightness would have the same.
  double variance = 0.0, finds = 0.0;
};

/// Whether a neighbour has as much variance by many finds: where a cone ends, a lamp that is met
/// often looks like one that is not.
bool is_rim(const std::vector<Chance>& chances, Film film, std::uint32_t x, std::uint32_t y) {
  const auto at = [&](std::uint32_t column, std::uint32_t row) -> const Chance& {
    return chances[std::size_t{row} * film.width + column];
  };
  for (std::uint32_t row = std::max(1u, y) - 1; row < std::min(film.height, y + 2); ++row) {
    for (std::uint32_t column = std::max(1u, x) - 1; column < std::min(film.width, x + 2);
         ++column) {
      const Chance& there = at(column, row);
      if (there.finds >= kFinds && there.variance >= at(x, y).variance) return true;
    }
  }
  return false;
}

/// Of a sample, in parts of the light seen; the median of all pixels, as one of them may have met
/// light that others did not.
double usual_error(const std::vector<MeanLight>& seen, double samples) {
  std::vector<double> errors;
  for (const MeanLight& each : seen) {
    if (each.mean > 0.0) errors.push_back(each.error / each.mean * std::sqrt(samples));
  }
  if (errors.empty()) return 0.0;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::ranges::nth_element(errors, middle);
  return *middle;
}

bool is_met(const MeanLight& met, const MeanLight& nearly) {
  return met.mean >= kSure * met.error && 2.0 * met.mean >= nearly.mean;
}

}  // namespace

std::vector<UnmetPart> find_unmet_parts(Scene& scene, Trials& trials, PhotonKind kind, Film film,
                                        std::uint32_t samples, double budget, double mean) {
  std::vector<UnmetPart> parts;
  const float radiance = rare_radiance(mean, kSquare * samples);
  scene.widened_lamps = WidenedLamps(scene.lights, scene.luminaires, radiance);
  if (scene.widened_lamps.empty()) return parts;
  const TracingOptions before = scene.options;
  kind.sharing = 1;
  const Film small = trials.reduced(budget / (2 * Trials::kImages * kSamples));
  const auto light = [&](TracingOptions::Gathered gathered, std::uint32_t times = 1) {
    scene.options.gathered = gathered;
    return means_of_pixels(trials.images(kind, small, whole(small, times * kSamples)));
  };
  const double enough = kEnough / (Trials::kImages * kSamples * pixels_of(small));
  const auto times = static_cast<std::uint32_t>(std::clamp<double>(enough, 1.0, kMoreTimes));
  const auto seen = light(TracingOptions::Gathered::kWithAll);
  // The light that is met must be these lamps': with few samples the even sky is brighter than
  // `radiance`, is met surely, and is no sign of a lamp that isn't.
  scene.options.least_radiance =
      std::max(radiance, kDimWavelengths * scene.widened_lamps.least_radiance());
  const auto nearly = light(TracingOptions::Gathered::kNearlyMet, times);
  const auto squares = light(TracingOptions::Gathered::kNearlyMetSquared, times);
  const double of_square = kSquare * samples;
  std::vector<Chance> chances(nearly.size());
  for (std::size_t pixel = 0; pixel < nearly.size(); ++pixel) {
    const double light_there = nearly[pixel].mean;
    if (!(light_there > 0.0)) continue;
    const double variance = kLuminanceOfOne * squares[pixel].mean / of_square;
    chances[pixel] = {variance, light_there * light_there / variance};
  }
  const double usual = usual_error(seen, double{Trials::kImages} * kSamples) / std::sqrt(of_square);
  std::vector<MeanLight> met;
  for (std::size_t pixel = 0; pixel < nearly.size(); ++pixel) {
    const MeanLight& there = nearly[pixel];
    const auto x = static_cast<std::uint32_t>(pixel % small.width);
    const auto y = static_cast<std::uint32_t>(pixel / small.width);
    if (!(there.mean > 0.0) || is_rim(chances, small, x, y)) continue;
    const double around = std::max(seen[pixel].mean, kDark * mean);
    if (!(std::sqrt(chances[pixel].variance) > std::max(kSmall, usual) * around)) continue;
    const double most = there.mean + kStandardErrors * there.error;
    if (met.empty()) met = light(TracingOptions::Gathered::kMet);
    if (is_met(met[pixel], there)) continue;
    const auto edge = [](std::uint32_t i, std::uint32_t of, std::uint32_t full) {
      return static_cast<std::uint32_t>(std::uint64_t{i} * full / of);
    };
    const std::uint32_t left = edge(x, small.width, film.width),
                        top = edge(y, small.height, film.height);
    parts.push_back({left, top, edge(x + 1, small.width, film.width) - left,
                     edge(y + 1, small.height, film.height) - top, most / around});
  }
  scene.options = before;
  scene.widened_lamps = {};
  return parts;
}

}  // namespace nocturne

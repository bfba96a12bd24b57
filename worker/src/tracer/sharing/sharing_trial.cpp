#include "tracer/sharing/sharing_trial.h"

#include <algorithm>
#include <cmath>

namespace nocturne {
namespace {

/// Pixels that share; edge of the squares, pixels: a film's few corners of much noise are one of
/// many small ones, and one of few large ones; images of each.
constexpr std::uint32_t kSharing = 16, kSquare = 8, kImages = 2;
/// Samples of a pixel, many where they leave so many squares: what sharing is worth depends on how
/// many are stratified together. Not 32: the grid of blocks stands still so long, and then sharing
/// seems to lose nothing where light is direct; at 64 it loses a factor of three (colour chart).
constexpr std::uint32_t kMany = 64, kFew = 16;
constexpr double kEnough = 16.0;
/// Of an occlusion query between neighbours, in rays of photons: measured, docs/decisions/0115.
constexpr double kQueryCost = 0.5;
/// Part of a mean by which two may differ.
constexpr double kDiffers = 0.01;

std::vector<double> means_of_squares(const PilotImages& images) {
  std::vector<double> means;
  const std::vector<PixelLight> light = light_of_pixels(images);
  auto pixel = light.begin();
  for (const TileSums& square : images.images.front()) {
    const std::size_t count = std::size_t{square.width} * square.height;
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += (pixel++)->mean;
    means.push_back(sum / static_cast<double>(count));
  }
  return means;
}

double means_differ(const PilotImages& alone, const PilotImages& shared) {
  const auto one = means_of_squares(alone), other = means_of_squares(shared);
  if (one.size() < 2 || !(is_more(one, other, kFault) || is_more(other, one, kFault))) return 0.0;
  const double differ = mean_and_error(other).mean / mean_and_error(one).mean - 1.0;
  return std::fabs(differ) > kDiffers ? differ : 0.0;
}

}  // namespace

SharingTrial try_sharing(Trials& trials, Film film, const PhotonKind& kind, double budget) {
  const auto affordable = [&](std::uint32_t samples) {
    return budget / (2.0 * kImages * samples * kSquare * kSquare);
  };
  const double enough = std::min<double>(kEnough, trials.squares_of_film(kSquare));
  const std::uint32_t samples = affordable(kMany) >= enough ? kMany : kFew;
  const double wanted = std::max(1.0, affordable(samples));
  const auto squares = trials.some_squares(wanted, kSquare, samples);
  PhotonKind sharing = kind;
  sharing.sharing = kSharing;
  const PilotImages alone = trials.images(kind, film, squares, kImages),
                    shared = trials.images(sharing, film, squares, kImages);
  const auto figures = figures_of_methods(
      {{kind, {}}, {sharing, {}}},
      [&](const PhotonKind& each) -> const PilotImages& { return each == kind ? alone : shared; },
      1.0);
  SharingTrial found{figures[0].sensor, figures[1].sensor, means_differ(alone, shared)};
  found.shared.cost = found.alone.cost + kQueryCost * (found.shared.cost - found.alone.cost);
  return found;
}

MethodFigures with_sharing(const MethodFigures& method, const SharingTrial& trial,
                           bool ratio_is_open) {
  MethodFigures shared = method;
  shared.method.sensor = trial.shared.kind;
  shared.sensor.relative_mse *= trial.shared.relative_mse / trial.alone.relative_mse;
  shared.sensor.cost *= trial.shared.cost / trial.alone.cost;
  if (shared.method.luminaires && ratio_is_open) {
    shared.ratio = best_forward_ratio(shared.sensor, shared.luminaires);
  }
  return shared;
}

}  // namespace nocturne

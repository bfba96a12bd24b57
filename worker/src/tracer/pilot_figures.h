// What a pilot's images tell of a way to trace.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tile/tile_sums.h"

namespace nocturne {

/// Independent images of the same squares of a film.
struct PilotImages {
  /// Of a pixel, in each image.
  std::uint32_t samples = 0;
  /// Of each image, square by square.
  std::vector<std::vector<TileSums>> images;
};

/// What photons of one kind did.
struct PilotFigures {
  enum Photons { kAdjoint, kAdjointOfBoth, kForward, kGuide, kSharing, kRareForward, kRareAdjoint };
  Photons photons;
  /// Pixels that share.
  std::uint32_t sharing = 1;
  /// Part of forward photons that is aimed at important shapes.
  float aimed = 0.0f;
  /// Adjoint photons that are sent towards important shapes, where there are any.
  bool hinted = true;
  /// Adjoint photons that are sent to where light was learned to come from.
  bool guided = false;
  /// Mean Y of the pilot's pixels, and its standard error.
  double mean = 0.0, mean_error = 0.0;
  /// Relative MSE of Y (docs/explanation/units-and-errors.md) of one sample of each pixel.
  double relative_mse = 0.0;
  /// The same over the pixels of each square; and the mean Y of each.
  std::vector<double> of_squares = {}, means_of_squares = {};
  /// What each group of pixels has of it: the sum is relative_mse.
  static constexpr std::size_t kGroups = 16;
  std::array<double, kGroups> of_groups = {};
  /// Of a sample, in rays of the usual cost.
  double cost = 0.0;
};

/// Y around each pixel: of two ways, each of which is a sum of images, by what is certain of their
/// means.
std::vector<double> shown_by(const std::vector<const PilotImages*>& one,
                             const std::vector<const PilotImages*>& other);

/// Of Y over all pixels, and its standard error by how the images differ; needs two.
std::array<double, 2> mean_and_error(const PilotImages& images);

/// Y of a pixel, and its variance between images, which needs two.
struct PixelLight {
  double mean = 0.0, variance = 0.0;
};
/// Of all squares, one after the other.
std::vector<PixelLight> light_of_pixels(const PilotImages& images);

double rays_of(const PilotImages& images);

/// Of each image another, of the same squares.
void subtract(PilotImages& from, const PilotImages& others);

using GroupErrors = std::array<double, PilotFigures::kGroups>;
/// Of both kinds of photons together, for each from the sensor `ratio` forward ones.
GroupErrors of_both(const PilotFigures& adjoint, const PilotFigures& forward, double ratio);
/// Standard error of log(sum of one / sum of other), by leaving out one group of pixels after the
/// other (the jackknife; Efron and Tibshirani, "An Introduction to the Bootstrap", 1993, equation
/// 11.5). Large where few pixels decide. Infinite where either is zero without one of the groups.
double error_of_log_ratio(std::span<const double> one, std::span<const double> other);

/// Of images whose pixels show `shown`.
PilotFigures figures_of(PilotFigures::Photons photons, std::uint32_t sharing,
                        const PilotImages& images, const std::vector<double>& shown);

}  // namespace nocturne

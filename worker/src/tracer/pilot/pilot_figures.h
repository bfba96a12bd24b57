// The figures that a pilot's images give for photons of one kind.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tile/tile_sums.h"
#include "tracer/pilot/pilot_method.h"

namespace nocturne {

/// Independent images of the same squares of a film.
struct PilotImages {
  /// Of a pixel, in each image.
  std::uint32_t samples = 0;
  /// Of each image, square by square.
  std::vector<std::vector<TileSums>> images;
};

/// Images of photons of one kind, all of the same squares of a film.
using ImagesOfKind = std::function<const PilotImages&(const PhotonKind&)>;

/// Of pixels in groups, such that neighbours are in different ones.
using GroupErrors = std::array<double, 16>;

/// The counts and results of photons of one kind.
struct PilotFigures {
  PhotonKind kind;
  /// Mean Y of the pilot's pixels, and its standard error.
  double mean = 0.0, mean_error = 0.0;
  /// Relative MSE of Y (docs/explanation/units-and-errors.md) of one sample of each pixel; and what
  /// each group of pixels has of it.
  double relative_mse = 0.0;
  GroupErrors of_groups{};
  /// Of a sample, in rays of the usual cost.
  double cost = 0.0;
};

/// A mean over the film, Y, and its standard error.
struct MeanLight {
  double mean = 0.0, error = 0.0;
};
/// By how much numbers differ of which this is the mean; needs two.
MeanLight mean_and_error(std::span<const double> numbers);
/// Of Y over all pixels of each image.
std::vector<double> means_of_images(const PilotImages& images);
MeanLight mean_and_error(const PilotImages& images);

/// Y of a pixel, and its variance between images, which needs two.
struct PixelLight {
  double mean = 0.0, variance = 0.0;
};
/// Of all squares, one after the other.
std::vector<PixelLight> light_of_pixels(const PilotImages& images);

double rays_of(const PilotImages& images);

/// Samples that found light, as many as were equally bright: (sum of Y)^2 / sum of Y^2 in each
/// pixel of each image (Kish 1965, "Survey Sampling", section 11.7). However bright, one counts as
/// one.
double finds_of(const PilotImages& images);

/// Of each image another, of the same squares.
void subtract(PilotImages& from, const PilotImages& others);
/// Of each image further samples, of the same squares.
void extend(PilotImages& to, PilotImages more);

/// Y around each pixel: the mean of 3 x 3 pixels within its square. A pixel's own samples are so
/// few that one bright one would hide how far it is off. `light`: of pixels as in `like`.
std::vector<double> light_around(const std::vector<double>& light, const PilotImages& like);

/// Standard error of log(sum of one / sum of other), by leaving out one group of pixels after the
/// other (the jackknife; Efron and Tibshirani, "An Introduction to the Bootstrap", 1993, equation
/// 11.5). Large where few pixels decide. Infinite where either is zero without one of the groups.
double error_of_log_ratio(const GroupErrors& one, const GroupErrors& other);
/// The same of log(sum of one).
double error_of_log(const GroupErrors& one);

/// Of images whose pixels show `shown`. `cost`: of a ray of theirs.
PilotFigures figures_of(const PhotonKind& kind, const PilotImages& images,
                        const std::vector<double>& shown, double cost);

}  // namespace nocturne

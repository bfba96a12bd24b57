#include "tracer/pilot_figures.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nocturne {
namespace {

/// Half an edge of the neighbourhood, pixels, whose mean is taken for what its middle shows: a
/// pixel's own samples are so few that one bright one would hide how far it is off.
constexpr std::uint32_t kAround = 3;

/// f(place among all pixels, Y) for an image.
template <class F>
void for_each_pixel(const std::vector<TileSums>& image, std::uint32_t samples, const F& f) {
  std::size_t place = 0;
  for (const TileSums& sums : image) {
    for (std::size_t at = 1; at < sums.sums.size(); at += sums.channels) {
      f(place++, sums.sums[at] / samples);
    }
  }
}

}  // namespace

std::array<double, 2> mean_and_error(const PilotImages& images) {
  std::vector<double> means;
  for (const auto& image : images.images) {
    double total = 0.0;
    std::size_t pixels = 0;
    for_each_pixel(image, images.samples, [&](std::size_t, double y) {
      total += y;
      ++pixels;
    });
    means.push_back(total / static_cast<double>(pixels));
  }
  const auto count = static_cast<double>(means.size());
  double mean = 0.0, squares = 0.0;
  for (const double each : means) mean += each / count;
  for (const double each : means) squares += (each - mean) * (each - mean);
  return {mean, std::sqrt(squares / (count - 1.0) / count)};
}

double rays_of(const PilotImages& images) {
  double rays = 0.0;
  for (const auto& image : images.images) {
    for (const TileSums& sums : image) rays += static_cast<double>(sums.rays);
  }
  return rays;
}

namespace {

double square_of_error(const std::vector<const PilotImages*>& way) {
  double square = 0.0;
  for (const PilotImages* images : way) {
    if (images->images.empty()) continue;
    const double error = mean_and_error(*images)[1];
    square += error * error;
  }
  return square;
}

/// Mean of a sample in the images of each part, all parts added up, times `weight`.
std::vector<TileSums> weighted(const std::vector<const PilotImages*>& way, double weight) {
  std::vector<TileSums> sum;
  for (const PilotImages* images : way) {
    const double samples = static_cast<double>(images->images.size()) * images->samples;
    for (const auto& image : images->images) {
      std::vector<TileSums> part = image;
      for (TileSums& square : part) {
        for (double& value : square.sums) value *= weight / samples;
      }
      if (sum.empty()) {
        sum = std::move(part);
      } else {
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
      }
    }
  }
  return sum;
}

double mean_around(const TileSums& image, std::uint32_t x, std::uint32_t y) {
  const auto from = [](std::uint32_t at) { return at < kAround ? 0 : at - kAround; };
  const std::uint32_t end_x = std::min(image.width, x + kAround + 1);
  const std::uint32_t end_y = std::min(image.height, y + kAround + 1);
  double sum = 0.0, pixels = 0.0;
  for (std::uint32_t row = from(y); row < end_y; ++row) {
    for (std::uint32_t column = from(x); column < end_x; ++column) {
      sum += image.sums[(std::size_t{row} * image.width + column) * image.channels + 1];
      ++pixels;
    }
  }
  return sum / pixels;
}

}  // namespace

std::vector<double> shown_by(const std::vector<const PilotImages*>& one,
                             const std::vector<const PilotImages*>& other) {
  const double certain = 1.0 / square_of_error(one), other_certain = 1.0 / square_of_error(other);
  const bool both = std::isfinite(certain) && std::isfinite(other_certain);
  const double weight = both ? certain / (certain + other_certain) : 0.5;
  std::vector<TileSums> mean = weighted(one, weight);
  const std::vector<TileSums> rest = weighted(other, 1.0 - weight);
  std::vector<double> around;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    mean[i] += rest[i];
    for (std::uint32_t y = 0; y < mean[i].height; ++y) {
      for (std::uint32_t x = 0; x < mean[i].width; ++x)
        around.push_back(mean_around(mean[i], x, y));
    }
  }
  return around;
}

PilotFigures figures_of(PilotFigures::Photons photons, std::uint32_t sharing,
                        const PilotImages& images, const std::vector<double>& shown) {
  const auto pixels = static_cast<double>(shown.size());
  const auto count = static_cast<double>(images.images.size());
  std::vector<double> sums(shown.size()), squares(shown.size());
  for (const auto& image : images.images) {
    for_each_pixel(image, images.samples, [&](std::size_t pixel, double y) {
      sums[pixel] += y;
      squares[pixel] += y * y;
    });
  }
  double all = 0.0;
  for (const double y : shown) all += y / pixels;
  const auto [mean, error] = mean_and_error(images);
  PilotFigures found{.photons = photons, .sharing = sharing, .mean = mean, .mean_error = error};
  std::size_t pixel = 0;
  for (const TileSums& square : images.images.front()) {
    const std::size_t end = pixel + std::size_t{square.width} * square.height;
    double errors = 0.0;
    for (; pixel < end; ++pixel) {
      const double variance =
          std::max(0.0, squares[pixel] - sums[pixel] * sums[pixel] / count) / (count - 1.0);
      const double scale = shown[pixel] * shown[pixel] + 0.01 * all * all;
      if (scale > 0.0) errors += images.samples * variance / scale;
    }
    found.relative_mse += errors / pixels;
    found.of_squares.push_back(errors / (square.width * square.height));
  }
  found.cost = rays_of(images) / (pixels * count * images.samples);
  return found;
}

}  // namespace nocturne

#include "tracer/pilot_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "math/functions.h"

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

std::vector<PixelLight> light_of_pixels(const PilotImages& images) {
  const auto count = static_cast<double>(images.images.size());
  std::vector<double> sums, squares;
  for (const auto& image : images.images) {
    for_each_pixel(image, images.samples, [&](std::size_t pixel, double y) {
      if (pixel == sums.size()) {
        sums.push_back(0.0);
        squares.push_back(0.0);
      }
      sums[pixel] += y;
      squares[pixel] += y * y;
    });
  }
  std::vector<PixelLight> light(sums.size());
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] = {sums[i] / count,
                std::max(0.0, squares[i] - sums[i] * sums[i] / count) / (count - 1.0)};
  }
  return light;
}

void subtract(PilotImages& from, const PilotImages& others) {
  for (std::size_t i = 0; i < from.images.size(); ++i) {
    for (std::size_t square = 0; square < from.images[i].size(); ++square) {
      std::vector<double>& sums = from.images[i][square].sums;
      const std::vector<double>& others_sums = others.images[i][square].sums;
      for (std::size_t s = 0; s < sums.size(); ++s) sums[s] -= others_sums[s];
    }
  }
}

GroupErrors of_both(const PilotFigures& adjoint, const PilotFigures& forward, double ratio) {
  GroupErrors both{};
  for (std::size_t i = 0; i < both.size(); ++i) {
    both[i] = adjoint.of_groups[i] + forward.of_groups[i] / ratio;
  }
  return both;
}

double error_of_log_ratio(std::span<const double> one, std::span<const double> other) {
  const double all = std::accumulate(one.begin(), one.end(), 0.0),
               all_of_other = std::accumulate(other.begin(), other.end(), 0.0);
  const auto count = static_cast<double>(one.size());
  std::vector<double> logarithms;
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const double left = all - one[i], left_of_other = all_of_other - other[i];
    if (!(left > 0.0 && left_of_other > 0.0)) return std::numeric_limits<double>::infinity();
    logarithms.push_back(math::log(left / left_of_other));
    mean += logarithms.back() / count;
  }
  for (const double each : logarithms) squares += (each - mean) * (each - mean);
  return std::sqrt((count - 1.0) / count * squares);
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
  const std::vector<PixelLight> light = light_of_pixels(images);
  double all = 0.0;
  for (const double y : shown) all += y / pixels;
  const auto [mean, error] = mean_and_error(images);
  PilotFigures found{.photons = photons, .sharing = sharing, .mean = mean, .mean_error = error};
  std::size_t pixel = 0;
  for (const TileSums& square : images.images.front()) {
    const std::size_t begin = pixel, end = pixel + std::size_t{square.width} * square.height;
    double errors = 0.0, total = 0.0;
    for (; pixel < end; ++pixel) {
      const double scale = shown[pixel] * shown[pixel] + 0.01 * all * all;
      total += light[pixel].mean;
      if (!(scale > 0.0)) continue;
      const double of_pixel = images.samples * light[pixel].variance / scale;
      errors += of_pixel;
      // Neighbours are in different groups.
      const std::size_t x = (pixel - begin) % square.width, y = (pixel - begin) / square.width;
      found.of_groups[(x + 5 * y) % PilotFigures::kGroups] += of_pixel / pixels;
    }
    found.relative_mse += errors / pixels;
    found.of_squares.push_back(errors / (square.width * square.height));
    found.means_of_squares.push_back(total / (square.width * square.height));
  }
  found.cost = rays_of(images) / (pixels * count * images.samples);
  return found;
}

}  // namespace nocturne

#include "tracer/pilot/pilot_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "math/functions.h"

namespace nocturne {
namespace {

/// Half an edge of the neighbourhood, pixels, whose mean is taken for what its middle shows.
constexpr std::uint32_t kAround = 1;

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

MeanLight mean_and_error(std::span<const double> numbers) {
  const auto count = static_cast<double>(numbers.size());
  double mean = 0.0, squares = 0.0;
  for (const double each : numbers) mean += each / count;
  for (const double each : numbers) squares += (each - mean) * (each - mean);
  return {mean, std::sqrt(squares / (count - 1.0) / count)};
}

std::vector<double> means_of_images(const PilotImages& images) {
  std::vector<double> means;
  for (const auto& image : images.images) {
    double total = 0.0, pixels = 0.0;
    for_each_pixel(image, images.samples, [&](std::size_t, double y) {
      total += y;
      ++pixels;
    });
    means.push_back(total / pixels);
  }
  return means;
}

MeanLight mean_and_error(const PilotImages& images) {
  return mean_and_error(means_of_images(images));
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

void extend(PilotImages& to, PilotImages more) {
  if (to.images.empty()) {
    to = std::move(more);
    return;
  }
  to.samples += more.samples;
  for (std::size_t i = 0; i < to.images.size(); ++i) {
    for (std::size_t square = 0; square < to.images[i].size(); ++square) {
      to.images[i][square] += more.images[i][square];
    }
  }
}

double error_of_log_ratio(const GroupErrors& one, const GroupErrors& other) {
  const double all = std::accumulate(one.begin(), one.end(), 0.0),
               all_of_other = std::accumulate(other.begin(), other.end(), 0.0);
  std::vector<double> logarithms;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const double left = all - one[i], left_of_other = all_of_other - other[i];
    if (!(left > 0.0 && left_of_other > 0.0)) return std::numeric_limits<double>::infinity();
    logarithms.push_back(math::log(left / left_of_other));
  }
  return (static_cast<double>(one.size()) - 1.0) * mean_and_error(logarithms).error;
}

double error_of_log(const GroupErrors& one) {
  GroupErrors even;
  even.fill(1.0);
  return error_of_log_ratio(one, even);
}

double rays_of(const PilotImages& images) {
  double rays = 0.0;
  for (const auto& image : images.images) {
    for (const TileSums& sums : image) rays += static_cast<double>(sums.rays);
  }
  return rays;
}

double finds_of(const PilotImages& images) {
  double finds = 0.0;
  for (const auto& image : images.images) {
    for (const TileSums& sums : image) {
      for (std::size_t at = 0; at < sums.sums.size(); at += sums.channels) {
        const double y = sums.sums[at + 1], squares = sums.sums[at + TileSums::kXyzValues];
        if (squares > 0.0) finds += y * y / squares;
      }
    }
  }
  return finds;
}

std::vector<double> light_around(const std::vector<double>& light, const PilotImages& like) {
  std::vector<double> around;
  std::size_t square = 0;
  for (const TileSums& of : like.images.front()) {
    const auto from = [](std::uint32_t at) { return at < kAround ? 0 : at - kAround; };
    for (std::uint32_t y = 0; y < of.height; ++y) {
      for (std::uint32_t x = 0; x < of.width; ++x) {
        double sum = 0.0, pixels = 0.0;
        for (std::uint32_t row = from(y); row < std::min(of.height, y + kAround + 1); ++row) {
          for (std::uint32_t column = from(x); column < std::min(of.width, x + kAround + 1);
               ++column) {
            sum += light[square + std::size_t{row} * of.width + column];
            ++pixels;
          }
        }
        around.push_back(sum / pixels);
      }
    }
    square += std::size_t{of.width} * of.height;
  }
  return around;
}

PilotFigures figures_of(const PhotonKind& kind, const PilotImages& images,
                        const std::vector<double>& shown, double cost) {
  const auto pixels = static_cast<double>(shown.size());
  const std::vector<PixelLight> light = light_of_pixels(images);
  double all = 0.0;
  for (const double y : shown) all += y / pixels;
  const auto [mean, error] = mean_and_error(images);
  PilotFigures found{.kind = kind, .mean = mean, .mean_error = error};
  std::size_t pixel = 0;
  for (const TileSums& square : images.images.front()) {
    for (std::uint32_t y = 0; y < square.height; ++y) {
      for (std::uint32_t x = 0; x < square.width; ++x, ++pixel) {
        const double scale = shown[pixel] * shown[pixel] + 0.01 * all * all;
        if (!(scale > 0.0)) continue;
        const double of_pixel = images.samples * light[pixel].variance / scale / pixels;
        found.of_groups[(x + 5 * y) % found.of_groups.size()] += of_pixel;
        found.relative_mse += of_pixel;
      }
    }
  }
  const auto count = static_cast<double>(images.images.size());
  found.cost = cost * rays_of(images) / (pixels * count * images.samples);
  return found;
}

}  // namespace nocturne

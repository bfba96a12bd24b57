#include "spectrum/rgb_spectra.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace nocturne {
namespace {

// Nearer to 0 and 1 the sigmoid's argument grows without bound. As the table's maker has it.
constexpr float kDarkest = 1e-4f, kBrightest = 1.0f - 1e-4f;

bool finite(const SigmoidSpectrum& s) {
  return std::isfinite(s.c0) && std::isfinite(s.c1) && std::isfinite(s.c2);
}

// What the sigmoid makes `value` of.
float inverse_sigmoid(float value) {
  const float v = std::clamp(value, kDarkest, kBrightest);
  return (v - 0.5f) / std::sqrt(v * (1.0f - v));
}

SigmoidSpectrum grey(float value) { return {0.0f, 0.0f, inverse_sigmoid(value)}; }

// A place along an axis of the table.
struct GridCell {
  std::size_t cell;
  float fraction;
};

GridCell place(float position, std::size_t resolution) {
  const std::size_t cell = std::min(static_cast<std::size_t>(position), resolution - 2);
  return {cell, position - static_cast<float>(cell)};
}

}  // namespace

RgbSpectra::RgbSpectra(std::vector<float> scales, std::vector<SigmoidSpectrum> coefficients)
    : scales_(std::move(scales)), coefficients_(std::move(coefficients)) {
  const std::size_t n = scales_.size();
  if (n < kMinResolution || n > kMaxResolution || coefficients_.size() != 3 * n * n * n) {
    throw std::invalid_argument("an RGB table of a size that none has");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!(scales_[i] >= 0.0f && scales_[i] <= 1.0f) || (i > 0 && !(scales_[i] > scales_[i - 1]))) {
      throw std::invalid_argument("an RGB table whose scales do not increase within [0, 1]");
    }
  }
  if (!std::ranges::all_of(coefficients_, finite)) {
    throw std::invalid_argument("an RGB table with a value that is not finite");
  }
}

SigmoidSpectrum RgbSpectra::operator()(const std::array<float, 3>& rgb) const {
  std::array<float, 3> c;
  for (std::size_t i = 0; i < 3; ++i) c[i] = std::clamp(rgb[i], 0.0f, 1.0f);
  if (c[0] == c[1] && c[1] == c[2]) return grey(c[0]);
  const auto brightest = static_cast<std::size_t>(std::ranges::max_element(c) - c.begin());
  const std::size_t n = scales_.size();
  const float steps = static_cast<float>(n - 1) / c[brightest];
  const GridCell x = place(c[(brightest + 1) % 3] * steps, n);
  const GridCell y = place(c[(brightest + 2) % 3] * steps, n);
  const float scale = std::clamp(c[brightest], scales_.front(), scales_.back());
  const auto above = static_cast<std::size_t>(
      std::upper_bound(scales_.begin() + 1, scales_.end() - 1, scale) - scales_.begin());
  // Straight in the sigmoid's argument, as coefficients of dark colours nearly are.
  const float below = inverse_sigmoid(scales_[above - 1]);
  const float span = inverse_sigmoid(scales_[above]) - below;
  const GridCell z{above - 1, span > 0.0f ? (inverse_sigmoid(scale) - below) / span : 1.0f};
  SigmoidSpectrum sum{0.0f, 0.0f, 0.0f};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
    const float weight = (i ? x.fraction : 1.0f - x.fraction) *
                         (j ? y.fraction : 1.0f - y.fraction) *
                         (k ? z.fraction : 1.0f - z.fraction);
    const SigmoidSpectrum& at =
        coefficients_[((brightest * n + z.cell + k) * n + y.cell + j) * n + x.cell + i];
    sum.c0 += weight * at.c0;
    sum.c1 += weight * at.c1;
    sum.c2 += weight * at.c2;
  }
  return sum;
}

}  // namespace nocturne

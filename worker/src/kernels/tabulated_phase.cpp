#include "kernels/tabulated_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace nocturne {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("a tabulated phase function " + what);
}

void check_sizes(std::size_t rows, std::size_t columns, std::size_t values) {
  if (rows < 1 || rows > TabulatedPhase::kMaxWavelengths) {
    refuse("without 1 to " + std::to_string(TabulatedPhase::kMaxWavelengths) + " wavelengths");
  }
  if (columns < 2 || columns > TabulatedPhase::kMaxCosines) {
    refuse("without 2 to " + std::to_string(TabulatedPhase::kMaxCosines) + " cosines");
  }
  if (rows * columns > TabulatedPhase::kMaxValues) refuse("with too many values");
  if (values != rows * columns) refuse("without one value for each wavelength and cosine");
}

bool is_in_range(const ScatteringElements& at) {
  return std::ranges::all_of(std::array{at.s12, at.s22, at.s33, at.s34, at.s44},
                             [](float x) { return std::fabs(x) <= 1.0f; });
}

template <class T>
bool increases(const std::vector<T>& values) {
  return std::ranges::all_of(values, [](T x) { return std::isfinite(x); }) &&
         std::ranges::adjacent_find(values, std::greater_equal<>{}) == values.end();
}

}  // namespace

TabulatedPhase::TabulatedPhase(const std::vector<double>& wavelengths, std::vector<double> cosines,
                               std::vector<float> values, std::vector<ScatteringElements> matrix)
    : wavelengths_(wavelengths.begin(), wavelengths.end()),
      cosines_(std::move(cosines)),
      values_(std::move(values)),
      matrix_(std::move(matrix)) {
  check_sizes(wavelengths_.size(), cosines_.size(), values_.size());
  if (!matrix_.empty() && matrix_.size() != values_.size()) {
    refuse("whose matrix has not one element for each value");
  }
  if (!std::ranges::all_of(matrix_, is_in_range)) refuse("with an element of its matrix beyond 1");
  if (!increases(wavelengths_)) refuse("whose wavelengths do not increase");
  if (!increases(cosines_) || cosines_.front() != -1.0 || cosines_.back() != 1.0) {
    refuse("whose cosines do not increase from -1 to 1");
  }
  if (!std::ranges::all_of(values_, [](float x) { return std::isfinite(x) && x >= 0.0f; })) {
    refuse("with a value that is negative or not finite");
  }
  const std::size_t cells = cosines_.size() - 1;
  cumulative_.reserve(wavelengths_.size() * cells);
  for (std::size_t row = 0; row < wavelengths_.size(); ++row) {
    float* const value = &values_[row * cosines_.size()];
    const auto mass = [&](std::size_t i) {
      return std::numbers::pi * (cosines_[i + 1] - cosines_[i]) *
             (static_cast<double>(value[i]) + static_cast<double>(value[i + 1]));
    };
    double total = 0.0;
    for (std::size_t i = 0; i < cells; ++i) total += mass(i);
    if (!(total > 0.0)) refuse("that is zero at all angles of a wavelength");
    for (std::size_t i = 0; i <= cells; ++i) {
      value[i] = static_cast<float>(static_cast<double>(value[i]) / total);
    }
    double below = 0.0;
    for (std::size_t i = 0; i < cells; ++i) cumulative_.push_back(below += mass(i));
  }
}

TabulatedPhase::RowsAt TabulatedPhase::rows_at(float wavelength_nm) const {
  if (!(wavelength_nm > wavelengths_.front())) return {0, 0.0f};
  const auto above = std::ranges::upper_bound(wavelengths_, wavelength_nm);
  const auto low = static_cast<std::size_t>(above - wavelengths_.begin()) - 1;
  if (above == wavelengths_.end()) return {low, 0.0f};
  return {low, (wavelength_nm - wavelengths_[low]) / (*above - wavelengths_[low])};
}

TabulatedPhase::CosineCell TabulatedPhase::place(double cosine) const {
  const auto above = std::upper_bound(cosines_.begin() + 1, cosines_.end() - 1, cosine);
  const auto cell = static_cast<std::size_t>(above - cosines_.begin()) - 1;
  const double t = (cosine - cosines_[cell]) / (*above - cosines_[cell]);
  return {cell, static_cast<float>(std::clamp(t, 0.0, 1.0))};
}

double TabulatedPhase::sample(std::size_t row, float u) const {
  const std::size_t cells = cosines_.size() - 1;
  const double* const below = &cumulative_[row * cells];
  // The sum of a row is 1 but for rounding.
  const double mass = static_cast<double>(u) * below[cells - 1];
  const auto cell =
      static_cast<std::size_t>(std::upper_bound(below, below + cells - 1, mass) - below);
  const float* const value = &values_[row * cosines_.size() + cell];
  const double low = static_cast<double>(value[0]), high = static_cast<double>(value[1]);
  const double width = cosines_[cell + 1] - cosines_[cell];
  // Of the cell's mass, as the area of a trapezium that starts with height `low`.
  const double area =
      (mass - (cell > 0 ? below[cell - 1] : 0.0)) / (2.0 * std::numbers::pi * width);
  const double root = std::sqrt(std::max(0.0, low * low + 2.0 * (high - low) * area));
  const double t = low + root > 0.0 ? 2.0 * area / (low + root) : 0.0;
  return cosines_[cell] + std::clamp(t, 0.0, 1.0) * width;
}

}  // namespace nocturne

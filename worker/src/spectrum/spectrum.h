// A function of wavelength: a constant, or linear between equally spaced values; plus lines. Unit
// as used (reflectance: 1; radiance: W m-2 sr-1 nm-1); wavelengths in nm.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "spectrum/lines.h"
#include "spectrum/spectral.h"

namespace nocturne {

class Spectrum {
 public:
  explicit Spectrum(float constant) : values_{constant, constant} {}

  /// At least two values, `step_nm` > 0; outside the table the end value holds, or zero.
  Spectrum(float first_nm, float step_nm, std::vector<float> values, bool zero_outside)
      : first_nm_(first_nm),
        inverse_step_(1.0f / step_nm),
        last_(static_cast<float>(values.size() - 1)),
        zero_outside_(zero_outside),
        values_(std::move(values)) {
    if (values_.size() < 2 || !(step_nm > 0.0f)) {
      throw std::invalid_argument("a tabulated spectrum needs two values and a positive step");
    }
  }

  /// The sum of both.
  Spectrum(Spectrum table, Lines lines) : Spectrum(std::move(table)) {
    lines_ = std::move(lines);
    has_lines_ = !lines_.empty();
  }

  float operator()(float wavelength_nm) const {
    const float table = in_table(wavelength_nm);
    return has_lines_ ? table + lines_(wavelength_nm) : table;
  }

  template <int N>
  Spectral<N> operator()(const Spectral<N>& wavelengths_nm) const {
    // A constant, or the same wherever: no need to look.
    if (inverse_step_ == 0.0f && !has_lines_) return values_[0];
    Spectral<N> all = in_table(wavelengths_nm);
    // One branch for a group; most spectra have no lines.
    if (has_lines_) all += each([this](float nm) { return lines_(nm); }, wavelengths_nm);
    return all;
  }

  float least() const { return *std::min_element(values_.begin(), values_.end()); }
  float most() const { return *std::max_element(values_.begin(), values_.end()); }

  /// From `first` to `last`, nm, first < last; exact, however narrow the interval in between.
  double mean_between(double first, double last) const {
    return (table_integral(first, last) + lines_.integral(first, last)) / (last - first);
  }

  /// Which wavelengths the scene's sensor sees, nm, first < last; without, those of the CIE's
  /// observers.
  void set_seen(float first_nm, float last_nm) {
    seen_first_ = first_nm;
    seen_last_ = last_nm;
  }

  /// Over the wavelengths that the sensor sees: for choices that may not depend on a photon's
  /// wavelength.
  float mean() const { return static_cast<float>(mean_between(seen_first_, seen_last_)); }

 private:
  float in_table(float wavelength_nm) const { return in_table(Spectral<1>(wavelength_nm))[0]; }

  template <int N>
  Spectral<N> in_table(const Spectral<N>& wavelengths_nm) const {
    using Lanes = typename Spectral<N>::Lanes;
    const Lanes zero{};
    const auto last_cell = static_cast<std::int32_t>(values_.size()) - 2;
    const Lanes position = (wavelengths_nm.lanes - first_nm_) * inverse_step_;
    Lanes t = position > zero ? position : zero;
    t = t < last_ ? t : zero + last_;
    auto cell = __builtin_convertvector(t, typename Spectral<N>::Integers);
    cell = cell < last_cell ? cell : cell - cell + last_cell;
    t -= __builtin_convertvector(cell, Lanes);
    Lanes low, high;
    for (std::size_t i = 0; i < N; ++i) {
      const float* at = &values_[static_cast<std::size_t>(cell[i])];
      low[i] = at[0];
      high[i] = at[1];
    }
    Lanes value = low + t * (high - low);
    if (zero_outside_) {
      value = position < zero ? zero : value;
      value = position > last_ ? zero : value;
    }
    return Spectral<N>(value);
  }

  double table_integral(double first, double last) const {
    if (inverse_step_ == 0.0f) return values_[0] * (last - first);
    const double step = 1.0 / inverse_step_;
    const double a = (first - first_nm_) / step, b = (last - first_nm_) / step;
    double sum = 0.0;
    if (!zero_outside_) {
      sum += values_.front() * std::max(0.0, std::min(b, 0.0) - a);
      sum += values_.back() * std::max(0.0, b - std::max<double>(a, last_));
    }
    for (std::size_t cell = 0; cell + 1 < values_.size(); ++cell) {
      const double from = std::clamp(a - static_cast<double>(cell), 0.0, 1.0);
      const double to = std::clamp(b - static_cast<double>(cell), 0.0, 1.0);
      const double middle = 0.5 * (from + to);
      sum += (to - from) * (values_[cell] + middle * (values_[cell + 1] - values_[cell]));
    }
    return sum * step;
  }

  float first_nm_ = 0.0f;
  float inverse_step_ = 0.0f;  // zero makes a constant: every position is 0
  float last_ = 1.0f;
  bool zero_outside_ = false;
  bool has_lines_ = false;
  float seen_first_ = 360.0f, seen_last_ = 830.0f;
  std::vector<float> values_;
  Lines lines_;
};

}  // namespace nocturne

// A function of wavelength: a constant, or linear between equally spaced values. Unit as used
// (reflectance: 1; radiance: W m-2 sr-1 nm-1); wavelengths in nm.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

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

  float operator()(float wavelength_nm) const {
    const float position = (wavelength_nm - first_nm_) * inverse_step_;
    if (zero_outside_ && (position < 0.0f || position > last_)) return 0.0f;
    const float clamped = std::clamp(position, 0.0f, last_);
    const std::size_t cell = std::min(static_cast<std::size_t>(clamped), values_.size() - 2);
    const float t = clamped - static_cast<float>(cell);
    return values_[cell] + t * (values_[cell + 1] - values_[cell]);
  }

  float mean() const {
    double sum = 0.0;
    for (const float value : values_) sum += value;
    return static_cast<float>(sum / static_cast<double>(values_.size()));
  }

 private:
  float first_nm_ = 0.0f;
  float inverse_step_ = 0.0f;  // zero makes a constant: every position is 0
  float last_ = 1.0f;
  bool zero_outside_ = false;
  std::vector<float> values_;
};

}  // namespace nocturne

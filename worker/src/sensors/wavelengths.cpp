#include "sensors/wavelengths.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace nocturne {

WavelengthSampler::WavelengthSampler(ResponseCurves curves, bool in_proportion_to_response)
    : curves_(std::move(curves)) {
  const std::size_t count = curves_.y.size();
  if (count < 2 || curves_.x.size() != count || curves_.z.size() != count ||
      !(curves_.step_nm > 0.0f)) {
    throw std::invalid_argument("response curves need one grid of at least two values");
  }
  const std::size_t cells = count - 1;
  std::vector<double> sums{0.0};
  for (std::size_t i = 0; i < cells; ++i) {
    const double at_ends = static_cast<double>(curves_.x[i]) + curves_.y[i] + curves_.z[i] +
                           curves_.x[i + 1] + curves_.y[i + 1] + curves_.z[i + 1];
    sums.push_back(sums.back() + (in_proportion_to_response ? at_ends : 1.0));
  }
  if (!(sums.back() > 0.0)) throw std::invalid_argument("the sensor responds to no wavelength");
  for (const double sum : sums) cumulative_.push_back(static_cast<float>(sum / sums.back()));
  cumulative_.back() = 1.0f;

  std::uint32_t cell = 0;
  for (std::size_t slice = 0; slice < 2 * cells; ++slice) {
    const float u = static_cast<float>(slice) / static_cast<float>(2 * cells);
    while (cumulative_[cell + 1] <= u) ++cell;
    guide_.push_back(cell);
  }
}

WavelengthSample WavelengthSampler::sample(float u) const {
  const auto slices = static_cast<float>(guide_.size());
  std::size_t cell = guide_[std::min(static_cast<std::size_t>(u * slices), guide_.size() - 1)];
  while (cumulative_[cell + 1] <= u) ++cell;
  while (cumulative_[cell] > u) --cell;  // where u * slices was rounded up
  const float share = cumulative_[cell + 1] - cumulative_[cell];
  const float t = (u - cumulative_[cell]) / share;
  const float nm = curves_.first_nm + (static_cast<float>(cell) + t) * curves_.step_nm;
  const float inverse_density = curves_.step_nm / share;
  const auto weight = [&](const std::vector<float>& curve) {
    return inverse_density * (curve[cell] + t * (curve[cell + 1] - curve[cell]));
  };
  return {nm, {weight(curves_.x), weight(curves_.y), weight(curves_.z)}};
}

float WavelengthSampler::pdf(float nm) const {
  const float position = (nm - curves_.first_nm) / curves_.step_nm;
  const auto cells = static_cast<float>(cumulative_.size() - 1);
  if (!(position >= 0.0f && position < cells)) return 0.0f;
  const auto cell = static_cast<std::size_t>(position);
  return (cumulative_[cell + 1] - cumulative_[cell]) / curves_.step_nm;
}

}  // namespace nocturne

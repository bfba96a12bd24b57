#include "sensors/wavelengths.h"

#include <stdexcept>
#include <utility>

namespace nocturne {
namespace {

// What any curve asks for is drawn: further ones count as much as X, Y and Z together, each scaled
// to their size.
std::vector<float> importance_of(const ResponseCurves& curves) {
  const std::size_t count = curves.y.size();
  bool equal = curves.x.size() == count && curves.z.size() == count;
  for (const auto& curve : curves.further) equal = equal && curve.size() == count;
  if (count < 2 || !equal || !(curves.step_nm > 0.0f)) {
    throw std::invalid_argument("response curves need one grid of at least two values");
  }
  std::vector<double> importance(count);
  double total = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    importance[i] = static_cast<double>(curves.x[i]) + curves.y[i] + curves.z[i];
    total += importance[i];
  }
  for (std::size_t further = 0; further < curves.further.size(); ++further) {
    if (!curves.light(further).all()) continue;
    const std::vector<float>& curve = curves.further[further];
    double sum = 0.0;
    for (const float value : curve) sum += value;
    for (std::size_t i = 0; sum > 0.0 && i < count; ++i) {
      importance[i] += (total > 0.0 ? total / sum : 1.0) * curve[i];
    }
  }
  if (!(*std::max_element(importance.begin(), importance.end()) > 0.0)) {
    throw std::invalid_argument("the sensor responds to no wavelength");
  }
  return {importance.begin(), importance.end()};
}

float wavelength(const ResponseCurves& curves, std::size_t i) {
  return curves.first_nm + static_cast<float>(i) * curves.step_nm;
}

DensityTable own_density(const ResponseCurves& curves, bool in_proportion_to_response) {
  const std::vector<float> importance = importance_of(curves);
  const std::size_t last = importance.size() - 1;
  if (!in_proportion_to_response)
    return {{curves.first_nm, wavelength(curves, last)}, {1.0f, 1.0f}};
  DensityTable density{{}, importance};
  for (std::size_t i = 0; i <= last; ++i) density.knots_nm.push_back(wavelength(curves, i));
  return density;
}

// Of linear pieces at `nm`, zero outside.
float interpolated(const std::vector<float>& knots, const std::vector<float>& values, float nm) {
  if (knots.empty() || nm < knots.front() || nm > knots.back()) return 0.0f;
  const auto at = std::upper_bound(knots.begin() + 1, knots.end() - 1, nm) - knots.begin();
  const auto high = static_cast<std::size_t>(at);
  const float width = knots[high] - knots[high - 1];
  const float t = width > 0.0f ? (nm - knots[high - 1]) / width : 0.0f;
  return values[high - 1] + t * (values[high] - values[high - 1]);
}

// Both are linear between the knots of both, so that these are all that has to be looked at.
void check_covers(const ResponseCurves& curves, const DensityTable& density) {
  const std::vector<float> importance = importance_of(curves);
  std::vector<float> grid;
  for (std::size_t i = 0; i < importance.size(); ++i) grid.push_back(wavelength(curves, i));
  const auto check = [&](bool covered) {
    if (!covered)
      throw std::invalid_argument("a wavelength density that is zero where a response is not");
  };
  for (std::size_t i = 0; i < grid.size(); ++i) {
    check(importance[i] == 0.0f || interpolated(density.knots_nm, density.values, grid[i]) > 0.0f);
  }
  const float first = density.knots_nm.front(), last = density.knots_nm.back();
  check(first <= grid.front() || interpolated(grid, importance, first) == 0.0f);
  check(last >= grid.back() || interpolated(grid, importance, last) == 0.0f);
  for (std::size_t i = 0; i < density.values.size(); ++i) {
    const float nm = density.knots_nm[i];
    if (nm < grid.front() || nm > grid.back()) {
      throw std::invalid_argument("a wavelength density that reaches out of the responses");
    }
    check(density.values[i] > 0.0f || interpolated(grid, importance, nm) == 0.0f);
  }
}

WavelengthDensity checked(const ResponseCurves& curves, const DensityTable& table) {
  WavelengthDensity density(table.knots_nm, table.values);
  check_covers(curves, table);
  return density;
}

}  // namespace

WavelengthSampler::WavelengthSampler(const ResponseCurves& curves, bool in_proportion_to_response)
    : WavelengthSampler(curves, own_density(curves, in_proportion_to_response)) {}

WavelengthSampler::WavelengthSampler(const ResponseCurves& curves, const DensityTable& density)
    : density_(checked(curves, density)),
      first_nm_(curves.first_nm),
      inverse_step_(1.0f / curves.step_nm),
      further_(curves.further),
      sums_(curves.sums),
      counting_(further_.size() - sums_.size()) {
  for (std::size_t i = 0; i < curves.y.size(); ++i) {
    xyz_.push_back(Row{curves.x[i], curves.y[i], curves.z[i], 0.0f});
  }
  for (std::size_t i = 0; i < further_.size(); ++i) {
    counted_.push_back(curves.light(i));
    tells_stokes_ = tells_stokes_ || counted_.back().stokes;
    tells_parts_ = tells_parts_ || counted_.back().part != LightPart::kWhole;
    if (const auto group = counted_.back().group) {
      light_groups_ = std::max(light_groups_, *group + 1);
    }
  }
}

}  // namespace nocturne

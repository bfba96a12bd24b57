// A density over wavelength, linear between knots, and draws from it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace nocturne {

/// Zero outside the knots. The cell between two knots is found in the cumulative density through a
/// guide table (Chen and Asau, 1974), the place inside by inverting its parabola, so that a
/// stratified u gives stratified wavelengths.
class WavelengthDensity {
 public:
  struct Draw {
    float nm;
    float inverse_density;  // nm
  };

  /// Knots in nm, not decreasing, and the density at each, of any size. Throws
  /// std::invalid_argument where they differ in number, are not finite, negative, out of order, or
  /// without any area.
  WavelengthDensity(const std::vector<float>& knots, const std::vector<float>& density);

  /// u in [0, 1).
  Draw sample(float u) const {
    const auto slices = static_cast<float>(guide_.size());
    std::size_t i = guide_[std::min(static_cast<std::size_t>(u * slices), guide_.size() - 1)];
    while (cells_[i + 1].before <= u) ++i;
    while (cells_[i].before > u) --i;  // where u * slices was rounded up
    const Cell& cell = cells_[i];
    const float share = cells_[i + 1].before - cell.before, width = cells_[i + 1].nm - cell.nm;
    // Where the density falls to zero, half of the last bit away from it.
    const float v = std::clamp((u - cell.before) / share, 0x1p-25f, 1.0f - 0x1p-24f);
    const float low = cell.low, high = 2.0f - low;  // over the cell's mean
    const float here = std::sqrt((1.0f - v) * low * low + v * high * high);
    const float t = std::min(2.0f * v / (low + here), 1.0f);
    return {cell.nm + t * width, width / (share * here)};
  }

  /// Of sample, 1/nm.
  float pdf(float nm) const;

 private:
  struct Cell {
    float nm;      // where it begins
    float before;  // what lies below
    float low;     // density at the beginning over the cell's mean, in [0, 2]
  };

  std::vector<Cell> cells_;           // and one more, where the last one ends
  std::vector<std::uint32_t> guide_;  // first cell that a slice of u can fall into
};

}  // namespace nocturne

// A density over wavelength, linear between knots, and draws from it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "spectrum/spectral.h"

namespace nocturne {

/// Zero outside the knots. The cell between two knots is found in the cumulative density through a
/// guide table (Chen and Asau, 1974), the place inside by inverting its parabola, so that a
/// stratified u gives stratified wavelengths.
class WavelengthDensity {
 public:
  template <int N>
  struct Draw {
    Spectral<N> nm;
    Spectral<N> inverse_density;  // nm
  };

  /// Knots in nm, not decreasing, and the density at each, of any size. Throws
  /// std::invalid_argument where they differ in number, are not finite, negative, out of order, or
  /// without any area.
  WavelengthDensity(const std::vector<float>& knots, const std::vector<float>& density);

  /// Each u in [0, 1).
  template <int N>
  Draw<N> sample(const Spectral<N>& u) const {
    Spectral<N> nm, width, before, share, low;
    for (std::size_t k = 0; k < N; ++k) {
      const std::size_t i = cell_of(u[k]);
      const Cell& cell = cells_[i];
      nm[k] = cell.nm;
      width[k] = cells_[i + 1].nm - cell.nm;
      before[k] = cell.before;
      share[k] = cells_[i + 1].before - cell.before;
      low[k] = cell.low;
    }
    using Lanes = typename Spectral<N>::Lanes;
    // Where the density falls to zero, half of the last bit away from it.
    constexpr float kMin = 0x1p-25f, kMax = 1.0f - 0x1p-24f;
    const Lanes one = Spectral<N>(1.0f).lanes;
    Lanes v = (u.lanes - before.lanes) / share.lanes;
    v = v < kMin ? kMin * one : v;
    v = v > kMax ? kMax * one : v;
    const Lanes high = 2.0f - low.lanes;  // over the cell's mean
    const Lanes here =
        sqrt(Spectral<N>((1.0f - v) * low.lanes * low.lanes + v * high * high)).lanes;
    Lanes t = 2.0f * v / (low.lanes + here);
    t = t > one ? one : t;
    return {Spectral<N>(nm.lanes + t * width.lanes),
            Spectral<N>(width.lanes / (share.lanes * here))};
  }

  /// Of sample, 1/nm.
  float pdf(float nm) const;

 private:
  struct Cell {
    float nm;      // where it begins
    float before;  // what lies below
    float low;     // density at the beginning over the cell's mean, in [0, 2]
  };

  std::size_t cell_of(float u) const {
    const auto slices = static_cast<float>(guide_.size());
    const auto slice = static_cast<std::uint32_t>(static_cast<std::int32_t>(u * slices));
    std::size_t i = guide_[std::min<std::size_t>(slice, guide_.size() - 1)];
    while (cells_[i + 1].before <= u) ++i;
    while (cells_[i].before > u) --i;  // where u * slices was rounded up
    return i;
  }

  std::vector<Cell> cells_;           // and one more, where the last one ends
  std::vector<std::uint32_t> guide_;  // first cell that a slice of u can fall into
};

}  // namespace nocturne

// A density over wavelength, linear between knots, and draws from it.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spectrum/rows.h"
#include "spectrum/spectral.h"

namespace nocturne {

/// Zero outside the knots. A stratified u gives stratified wavelengths. The unit interval has equal
/// slices, whose number is a power of two; over most of them the wavelength is a parabola, as near
/// to what belongs to the density as kSmooth, and a draw takes one look, no root and no division.
/// In the others, where the density rises steeply, as at narrow lines and far off the responses'
/// peaks, the place inside is found by inverting the density's own sum.
class WavelengthDensity {
 public:
  template <int N>
  struct Draw {
    Spectral<N> nm;
    Spectral<N> inverse_density;  // nm
  };
  /// Relative. An image without noise converges by how smoothly the density goes on, so this is
  /// what weights may jump by where slices meet.
  static constexpr double kSmooth = 1e-3;

  /// Knots in nm, not decreasing, and the density at each, of any size. Throws
  /// std::invalid_argument where they differ in number, are not finite, negative, out of order, or
  /// without any area.
  WavelengthDensity(const std::vector<float>& knots, const std::vector<float>& density);

  /// Each u in [0, 1).
  template <int N>
  Draw<N> sample(const Spectral<N>& u) const {
    using Lanes = typename Spectral<N>::Lanes;
    const auto number = __builtin_convertvector(u.lanes * kSlices, typename Spectral<N>::Integers);
    std::array<Row, N> slices;
    for (std::size_t k = 0; k < N; ++k) {
      slices[k] = std::bit_cast<Row>(slices_[place(static_cast<std::uint32_t>(number[k]))]);
    }
    const Spectral<N> knot = column(slices, 0), offset = column(slices, 1);
    const Spectral<N> slope = column(slices, 2), bend = column(slices, 3);
    // Exact: the slices are a power of two.
    const Spectral<N> inside(u.lanes - __builtin_convertvector(number, Lanes) * (1.0f / kSlices));
    const Spectral<N> bent = bend * inside;
    Draw<N> draw{knot + (offset + inside * (slope + bent)), slope + 2.0f * bent};
    bool steep = false;
    for (std::size_t k = 0; k < N; ++k) steep |= slope[k] == 0.0f;
    for (std::size_t k = 0; steep && k < N; ++k) [[unlikely]] {
        if (slope[k] != 0.0f) continue;
        const auto [nm, inverse_density] = invert(u[k], std::bit_cast<std::uint32_t>(knot[k]));
        draw.nm[k] = nm;
        draw.inverse_density[k] = inverse_density;
      }
    return draw;
  }

  /// Of sample, 1/nm.
  float pdf(float nm) const;

 private:
  struct Cell {
    float nm;      // where it begins
    float before;  // what lies below
    float low;     // density at the beginning over the cell's mean, in [0, 2]
  };
  struct Slice {
    // Begins at knot + offset, nm: lines may be narrower than what a float can tell there.
    float knot, offset;
    // One over the density is slope + 2 bend x, nm; x of [0, 1 / kSlices). A slope of 0: steep.
    float slope, bend;

    static Slice steep(std::uint32_t cell) { return {std::bit_cast<float>(cell), 0, 0, 0}; }
  };
  struct Inverted {
    float nm, inverse_density;
  };
  static constexpr std::uint32_t kSlices = 2048, kTogether = 4;

  // Slices that differ by a quarter, as those of a group do, lie side by side.
  static std::size_t place(std::uint32_t slice) {
    return kTogether * (slice % (kSlices / kTogether)) + slice / (kSlices / kTogether);
  }
  // Of a u that falls into this cell or a later one.
  Inverted invert(float u, std::uint32_t cell) const;

  std::vector<Cell> cells_;  // and one more, where the last one ends
  std::vector<Slice> slices_;
};

}  // namespace nocturne

// Radiance from all directions by an equal-area cylindrical map (Morley et al. 2006, section 6):
// rows are equal steps of z from 1 down to -1 in the map's frame, columns equal steps of azimuth
// from x towards y, so that all texels have the same solid angle. Radiance is the same all over a
// texel: scale x S(c0 l^2 + c1 l + c2) x spectrum (spectrum/sigmoid.h).
//
// Directions are drawn from a window of the map (rows and columns that the receiver can see), each
// texel in proportion to its mean radiance over visible wavelengths: a summed-area table gives the
// sum over any rectangle from four entries, so the row and then the column are found by bisection
// without any table per window. Sums are whole numbers of 64 bits, as differences of floating-point
// sums would lose the dark texels of a map with a sun in it: a texel counts at least 1, the map
// 2^61.
//
// Memory: 24 bytes per texel; 805 MB for 8192 x 4096.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "luminaires/light_sampling_context.h"
#include "spectrum/sigmoid.h"
#include "spectrum/spectrum.h"

namespace nocturne {

class EnvironmentMap {
 public:
  static constexpr std::uint32_t kMaxColumns = 8192, kMaxRows = 4096;

  /// Orthonormal axes of the map in the scene.
  struct Axes {
    Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  };
  /// As in the map's file.
  struct Texel {
    float scale, c0, c1, c2;
  };

  /// Texels by row. Finite numbers, scale not negative; throws std::invalid_argument.
  EnvironmentMap(std::uint32_t columns, std::uint32_t rows, std::vector<Texel> texels,
                 Spectrum spectrum, Axes axes);

  /// W m-2 sr-1 nm-1, from the unit direction.
  template <int N>
  Spectral<N> radiance(Vec3 direction, const Spectral<N>& wavelengths) const {
    const TexelPoint place = place_of(to_map(direction));
    const Texel& texel = texels_[std::size_t{place.row} * columns_ + place.column];
    if (texel.scale == 0.0f) return 0.0f;
    const SigmoidSpectrum shape{texel.c0, texel.c1, texel.c2};
    return texel.scale * (shape(wavelengths) * spectrum_(wavelengths));
  }

  /// Over all directions and visible wavelengths.
  double mean_radiance() const { return mean_radiance_; }

  /// A unit direction that `from` sees. Empty where all that it sees is black, and where the drawn
  /// one is below the horizon after all (the window is a rectangle of whole texels).
  std::optional<Vec3> sample(const LightSamplingContext& from, float u1, float u2) const;

  /// Density of `sample`, 1/sr.
  float pdf(const LightSamplingContext& from, Vec3 direction) const;

 private:
  struct TexelPoint {
    std::uint32_t row, column;
  };
  // Rows [row0, row1) and `columns` columns from column0 on, around the back if need be.
  struct Window {
    std::uint32_t row0, row1, column0, columns;
  };

  Vec3 to_map(Vec3 v) const { return {dot(v, axes_.x), dot(v, axes_.y), dot(v, axes_.z)}; }
  TexelPoint place_of(Vec3 in_map) const;
  Window window(const LightSamplingContext& from) const;
  void sum_up(const std::vector<float>& means);

  // The sum of all texels above `row` and left of `column`, which may be beyond the right edge.
  std::uint64_t corner(std::uint32_t row, std::uint32_t column) const {
    const std::uint64_t* sums = &sums_[std::size_t{row} * (columns_ + 1)];
    return column <= columns_ ? sums[column] : sums[columns_] + sums[column - columns_];
  }
  std::uint64_t weight(const Window& w) const {
    return corner(w.row1, w.column0 + w.columns) - corner(w.row1, w.column0) -
           corner(w.row0, w.column0 + w.columns) + corner(w.row0, w.column0);
  }

  std::uint32_t columns_, rows_;
  std::vector<Texel> texels_;
  Spectrum spectrum_;
  Axes axes_;
  double mean_radiance_ = 0.0;
  std::vector<std::uint64_t> sums_;  // (rows + 1) x (columns + 1)
};

}  // namespace nocturne

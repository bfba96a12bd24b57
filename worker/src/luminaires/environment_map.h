// Radiance from all directions by an equal-area cylindrical map (Morley et al. 2006, section 6):
// rows are equal steps of z from 1 down to -1 in the map's frame, columns equal steps of azimuth
// from x towards y, so that all texels have the same solid angle. Radiance is the same all over a
// texel: scale x S(c0 l^2 + c1 l + c2) x spectrum (spectrum/sigmoid.h).
//
// Directions are drawn from a window of the map (rows and columns that the receiver can see), each
// texel in proportion to its mean radiance over visible wavelengths, without any table per window:
// a summed-area table of every 32nd column, of more in small maps, gives a window's sum from four
// entries and the row, sums along each row the column; both are looked for where a guide says. Sums
// are whole numbers of 64 bits, as differences of floating-point sums would lose the dark texels of
// a map with a sun in it: a texel counts at least 1, the map 2^61.
//
// Memory: 24 bytes per texel and a half; 822 MB for 8192 x 4096.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "luminaires/cutpoint_table.h"
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

  struct Place {
    std::uint32_t row, column;
  };
  /// The texel in the unit direction.
  Place place_of(Vec3 direction) const;
  /// The same, whose radiance and density will be asked for: memory is asked for them now, as a map
  /// is larger than most caches.
  Place prefetch(Vec3 direction) const {
    const Place place = place_of(direction);
    __builtin_prefetch(&texels_[number(place)]);
    __builtin_prefetch(left_of(place.row) + place.column);
    return place;
  }
  std::uint32_t number(Place at) const { return at.row * columns_ + at.column; }

  /// W m-2 sr-1 nm-1, the same all over this texel.
  template <int N>
  Spectral<N> radiance(std::uint32_t texel, const Spectral<N>& wavelengths) const {
    const auto& [scale, c0, c1, c2] = texels_[texel];
    if (scale == 0.0f) return 0.0f;
    const SigmoidSpectrum shape{c0, c1, c2};
    return scale * (shape(wavelengths) * spectrum_(wavelengths));
  }

  /// Over all directions and visible wavelengths.
  double mean_radiance() const { return mean_radiance_; }

  /// A direction, its density, 1/sr, and the texel that it is in.
  struct Drawn {
    Vec3 direction;
    float pdf;
    std::uint32_t texel;
  };
  /// A unit direction that `from` sees. Empty where all that it sees is black, and where the drawn
  /// one is below the horizon after all (the window is a rectangle of whole strips).
  std::optional<Drawn> draw(const LightSamplingContext& from, float u1, float u2) const {
    return finish(from, begin(from, u1, u2));
  }

  /// A uniform number in whole sums, and the whole part of it.
  struct Target {
    double exact;
    std::uint64_t whole;
  };
  /// Half of a draw, up to where memory must be waited for.
  struct PartialSample {
    std::uint64_t total;  // of the window; 0: nothing there
    double z;
    std::uint32_t row;
    Target across;
    std::uint64_t before, around;  // that the row's sums differ by
    CutpointTable::Range columns;
  };
  PartialSample begin(const LightSamplingContext& from, float u1, float u2) const;
  std::optional<Drawn> finish(const LightSamplingContext& from, const PartialSample& draft) const;

  /// Density of `draw`, 1/sr, for a direction in this place.
  float pdf(const LightSamplingContext& from, Vec3 direction, Place place) const;

 private:
  // Rows [row0, row1) and `strips` strips of columns from strip0 on, around the back if need be.
  struct Window {
    std::uint32_t row0, row1, strip0, strips;
  };

  Vec3 to_map(Vec3 v) const { return {dot(v, axes_.x), dot(v, axes_.y), dot(v, axes_.z)}; }
  // Of a texel with this share of the samples.
  float density(std::uint64_t share, std::uint64_t total) const;
  Window window(const LightSamplingContext& from) const;
  void sum_up(const std::vector<float>& means);
  std::uint32_t row_at(const Window& w, std::uint64_t target) const;

  // The sum of all texels above `row` and left of `strip`, which may be beyond the right edge.
  std::uint64_t corner(std::uint32_t row, std::uint32_t strip) const {
    const std::uint64_t* sums = &sums_[std::size_t{row} * (strips_ + 1)];
    return strip <= strips_ ? sums[strip] : sums[strips_] + sums[strip - strips_];
  }
  std::uint64_t weight(const Window& w) const {
    if (w.strips == strips_) return sums_of_rows_[w.row1] - sums_of_rows_[w.row0];
    return corner(w.row1, w.strip0 + w.strips) - corner(w.row1, w.strip0) -
           corner(w.row0, w.strip0 + w.strips) + corner(w.row0, w.strip0);
  }
  // For each row, the sum to the left of a column, the right edge included.
  const std::uint64_t* left_of(std::uint32_t row) const {
    return &left_[std::size_t{row} * (columns_ + 1)];
  }

  std::uint32_t columns_, rows_;
  // Columns of a strip, and how many strips there are, the last one narrower.
  std::uint32_t strip_columns_, strips_;
  std::vector<Texel> texels_;
  Spectrum spectrum_;
  Axes axes_;
  double row_height_, column_width_, texels_per_steradian_;  // of z, radians
  double mean_radiance_ = 0.0;
  std::vector<std::uint64_t> left_;          // rows x (columns + 1)
  std::vector<std::uint64_t> sums_;          // (rows + 1) x (strips + 1)
  std::vector<std::uint64_t> sums_of_rows_;  // rows + 1: all above
  CutpointTable guide_of_columns_, guide_of_rows_;
};

}  // namespace nocturne

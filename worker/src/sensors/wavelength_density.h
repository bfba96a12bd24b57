// A density over wavelength, nearly linear between knots, and draws from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spectrum/spectral.h"

namespace nocturne {

/// The unit interval in equal slices, whose number is a power of two; each belongs to a piece of
/// the wavelengths, over which the density is even, so that a stratified u gives stratified
/// wavelengths and a draw takes one look and no division. Pieces follow what is asked for: none has
/// a knot inside, unless it is worth less than a slice and as even as that; zero where that is
/// zero.
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
    Draw<N> draw;
    for (std::size_t k = 0; k < N; ++k) {
      const auto slice = static_cast<std::uint32_t>(static_cast<std::int32_t>(u[k] * count_));
      const Piece& piece = pieces_[place(slice)];
      // Exact: the slices are a power of two.
      const float inside = u[k] - static_cast<float>(slice) * inverse_count_;
      draw.nm[k] = piece.knot + (piece.offset + inside * piece.inverse_density);
      draw.inverse_density[k] = piece.inverse_density;
    }
    return draw;
  }

  /// Of sample, 1/nm.
  float pdf(float nm) const;

 private:
  // Begins at knot + offset, nm: lines may be narrower than what a float can tell there.
  struct Piece {
    float knot, offset, inverse_density, unused;
  };
  static constexpr std::uint32_t kTogether = 4;

  // Slices that differ by a quarter, as those of a group do, lie side by side.
  std::size_t place(std::uint32_t slice) const {
    return kTogether * (slice & (quarter_ - 1)) + (slice >> shift_);
  }
  double begin(std::uint32_t slice) const {
    const Piece& piece = pieces_[place(slice)];
    return static_cast<double>(piece.knot) + static_cast<double>(piece.offset);
  }

  float count_ = 0.0f, inverse_count_ = 0.0f;
  std::uint32_t quarter_ = 0, shift_ = 0;
  std::vector<Piece> pieces_;
};

}  // namespace nocturne

// Smooth reflectance spectra of linear sRGB colours, from a table of sigmoid coefficients. Jakob
// and Hanika, "A low-dimensional function space for efficient spectral upsampling", Computer
// Graphics Forum 38(2), 2019, section 4.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "spectrum/sigmoid.h"

namespace nocturne {

class RgbSpectra {
 public:
  static constexpr std::size_t kMinResolution = 2, kMaxResolution = 64;

  /// `scales`: values of the brightest channel, increasing, in [0, 1]; their number is the
  /// resolution n. `coefficients`: 3 x n x n x n by brightest channel m (red, green, blue), scale,
  /// channel (m + 2) % 3 over it, channel (m + 1) % 3 over it; the ratios in equal steps from 0 to
  /// 1. All finite. Throws std::invalid_argument.
  RgbSpectra(std::vector<float> scales, std::vector<SigmoidSpectrum> coefficients);

  /// Of a colour taken to the nearest in [0, 1]. Greys are exact between 1e-4 and 1 - 1e-4, and
  /// those values beyond; colours are trilinear between the table's entries, along the scale
  /// in the argument that the sigmoid gives it.
  SigmoidSpectrum operator()(const std::array<float, 3>& rgb) const;

 private:
  std::vector<float> scales_;
  std::vector<SigmoidSpectrum> coefficients_;
};

}  // namespace nocturne

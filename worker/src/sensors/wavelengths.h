// The one wavelength of a photon, and what the sensor's X, Y, Z responses make of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace nocturne {

/// Sampled response curves on one equally spaced grid, linear in between; per nm, K_m included.
struct ResponseCurves {
  float first_nm, step_nm;
  std::vector<float> x, y, z;
};

struct WavelengthSample {
  float nm;
  /// Response over density: the mean of weight x spectral radiance is X, Y, Z (Y in cd/m2).
  std::array<float, 3> weight;
};

/// Draws wavelengths cell by cell of the response grid, with a constant density inside a cell: in
/// proportion to the mean of X + Y + Z there, or the same everywhere. The inverse of the cumulative
/// density is found through a guide table (Chen and Asau, 1974), so that a stratified u gives
/// stratified wavelengths.
class WavelengthSampler {
 public:
  /// Throws std::invalid_argument where the curves are shorter than two values, differ in length or
  /// are all zero.
  WavelengthSampler(ResponseCurves curves, bool in_proportion_to_response);

  /// u in [0, 1).
  WavelengthSample sample(float u) const;

  /// Density of sample, 1/nm; zero outside the grid.
  float pdf(float nm) const;

 private:
  ResponseCurves curves_;
  std::vector<float> cumulative_;     // cell count + 1 values from 0 to 1
  std::vector<std::uint32_t> guide_;  // first cell that a slice of u can fall into
};

}  // namespace nocturne

// Light that starts as given rays, such as those of a measured lamp (IES TM-25): only forward
// photons carry it.
#pragma once

#include <cstdint>
#include <vector>

#include "math/ray.h"
#include "spectrum/spectrum.h"

namespace nocturne {

class RaySet {
 public:
  /// As a file has it, little endian: where it starts, m, its direction, and its power, W.
  struct Recorded {
    float x, y, z, kx, ky, kz, watts;
  };

  /// `per_watt`: W/nm of a watt. Throws std::invalid_argument where there are no rays, one has no
  /// direction or a power that is negative or not finite, or none has power.
  RaySet(std::vector<Recorded> rays, Spectrum per_watt, std::uint32_t group);

  /// All power, W, and its mean over visible wavelengths, W/nm.
  double watts() const { return watts_; }
  double mean_flux() const;
  /// Of all rays together, W/nm.
  template <int N>
  Spectral<N> flux(const Spectral<N>& wavelengths_nm) const {
    return static_cast<float>(watts_) * per_watt_(wavelengths_nm);
  }
  /// A ray in proportion to its power; u in [0, 1) by steps of 2^-48 in two numbers, and a third.
  Ray draw(float coarse, float fine, float which) const;

  std::uint32_t light_group;

 private:
  /// A. J. Walker, "An Efficient Method for Generating Discrete Random Variables with General
  /// Distributions" (1977), by the tables of Vose (1991): `first` is drawn with the probability
  /// `share` in its place, else `other`.
  struct Place {
    float share;
    std::uint32_t other;
  };

  std::vector<Recorded> rays_;
  std::vector<Place> places_;
  Spectrum per_watt_;
  double watts_ = 0.0;
};

}  // namespace nocturne

// Light of hot gas and soot: a blackbody wherever something absorbs.
#pragma once

#include <utility>

#include "math/functions.h"
#include "media/grid_density.h"
#include "spectrum/spectral.h"

namespace nocturne {

class Glow {
 public:
  /// `temperature`: kelvin. `scale`: factor of the radiance, not negative.
  Glow(GridField temperature, float scale) : temperature_(std::move(temperature)), scale_(scale) {}

  /// W m-2 sr-1 nm-1. Planck's law; constants of CODATA 2018 (Tiesinga et al., Rev. Mod. Phys. 93,
  /// 2021): first radiation constant for spectral radiance 1.191042972e-16 W m2 sr-1, second
  /// 1.438776877e-2 m K.
  template <int N>
  Spectral<N> radiance(Vec3 position, const Spectral<N>& wavelengths_nm) const {
    constexpr float kFirst = 1.191042972e20f;  // W m-2 sr-1 nm-1 x nm^5
    constexpr float kSecond = 1.438776877e7f;  // nm K
    const float kelvin = temperature_.at(position);
    if (!(kelvin > 0.0f)) return 0.0f;
    return each(
        [&](float nm) {
          const float nm5 = nm * nm * nm * nm * nm;
          return scale_ * kFirst / (nm5 * math::expm1(kSecond / (nm * kelvin)));
        },
        wavelengths_nm);
  }

 private:
  GridField temperature_;
  float scale_;
};

}  // namespace nocturne

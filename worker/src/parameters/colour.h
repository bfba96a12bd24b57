// A function of wavelength that may vary over a surface. Unit as used.
#pragma once

#include <memory>
#include <utility>

#include "parameters/surface_point.h"
#include "parameters/texture_use.h"
#include "spectrum/rgb_spectra.h"
#include "spectrum/spectrum.h"

namespace nocturne {

class Colour {
 public:
  explicit Colour(Spectrum spectrum) : spectrum_(std::move(spectrum)) {}
  /// Of one channel: the spectrum times its value, kept in [0, most]. Of three (linear sRGB): the
  /// spectrum times the smooth reflectance spectrum of that colour, from `rgb`, which must be
  /// there. Throws std::invalid_argument.
  Colour(Spectrum spectrum, const TextureUse& use, std::shared_ptr<const RgbSpectra> rgb,
         float most);

  /// At the wavelengths of a group, nm.
  template <int N>
  Spectral<N> operator()(const SurfacePoint& point, const Spectral<N>& wavelengths) const {
    const Spectral<N> spectrum = spectrum_(wavelengths);
    return varying_ ? varying_->at(point, wavelengths) * spectrum : spectrum;
  }

  bool textured() const { return varying_ != nullptr; }

  /// Whether the texture makes it 0 at all wavelengths there.
  bool dark(const SurfacePoint& point) const;

  /// Mean over wavelengths and surface, for choices that may not depend on the photon's wavelength.
  float mean() const;

 private:
  struct Varying {
    TextureUse use;
    std::shared_ptr<const RgbSpectra> rgb;  // empty: one channel
    float most;

    template <int N>
    Spectral<N> at(const SurfacePoint& point, const Spectral<N>& wavelengths) const {
      if (rgb) return (*rgb)(use.rgb(point))(wavelengths);
      return std::clamp(use.grey(point), 0.0f, most);
    }
  };

  Spectrum spectrum_;
  std::shared_ptr<const Varying> varying_;
};

}  // namespace nocturne

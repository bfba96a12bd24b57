// Panes one behind the other with gaps between them, as one thin sheet: light is mirrored or goes
// straight on, with all reflections between the panes, and between the faces of each, summed
// without interference: Stokes, Proc. Royal Society 11, 1862; EN 410:2011, section 5.2, the same at
// normal incidence. The two polarisations are kept apart. A pane is
//   a sheet of a dielectric, with films on its faces (thin_film.h);
//   a film alone, such as a soap film, which interferes with itself;
//   one whose reflectances and transmittance were measured at normal incidence. How these depend on
//   the angle is taken from the fit to clear and to bronze glass of Finlayson, Arasteh, Huizenga,
//   Rubin and Reilly, WINDOW 4.0, LBL-33943, 1993, divided by its values at normal incidence.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/kernel.h"
#include "kernels/mueller.h"
#include "kernels/thin_film.h"
#include "spectrum/spectrum.h"

namespace nocturne {

/// Of a layer of whatever kind, for one polarisation: reflectance of its front and of its back, and
/// transmittance, which is the same from both sides.
struct LayerShares {
  double front, back, through;

  LayerShares turned() const { return {back, front, through}; }
};

/// `first` in front of `second`, and between them what lets `between` of the light through.
LayerShares one_behind_other(const LayerShares& first, const LayerShares& second,
                             double between = 1.0);

struct SheetPane {
  /// Of refraction, and internal transmittance of one crossing along the normal, in [0, 1].
  Spectrum index, transmittance;
  /// In the order in which light from outside meets the layers, at the front and at the back.
  ThinFilm front, back;
};
struct FilmPane {
  /// From the front.
  ThinFilm film;
};
struct MeasuredPane {
  /// At normal incidence, in air; front + transmittance and back + transmittance at most 1.
  Spectrum front, back, transmittance;
};
using Pane = std::variant<SheetPane, FilmPane, MeasuredPane>;

/// The same of the mean product of the field across the plane of incidence with the other's
/// conjugate, over that of the light that comes.
struct LayerProducts {
  Complex front, back, through;

  LayerProducts turned() const { return {back, front, through}; }
};

/// Of light kept apart by polarisation: across the plane of incidence, in it, and of both.
struct PolarisedLayers {
  LayerShares s, p;
  LayerProducts both;
};

/// What measured shares are at an angle.
LayerShares measured_shares(const LayerShares& along_normal, double cosine);

class Glazing;

template <int N>
struct BoundGlazing {
  const Glazing* glazing;
  Spectral<N> index_from, wavelengths;

  Spectral<N> albedo(Vec3 wo) const {
    return shares(wo, [](Shares s) { return std::min(1.0, s.reflected + s.transmitted); });
  }
  static Spectral<N> value(Vec3, Vec3) { return 0.0f; }
  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t) const;
  static Spectral<N> pdf(Vec3, Vec3) { return 0.0f; }
  static constexpr bool smooth() { return false; }
  static constexpr bool transmits() { return false; }

  Mueller<N> mueller(Vec3 wo, Vec3 wi, std::uint32_t photons) const;

 private:
  template <class F>
  Spectral<N> shares(Vec3 wo, const F& f) const;
};

class Glazing {
 public:
  /// Panes in the order in which light meets them.
  explicit Glazing(std::vector<Pane> panes);

  /// The lobe on the side of the light is on both sides.
  static constexpr bool has_delta_lobe() { return true; }
  static constexpr bool may_transmit() { return true; }

  template <int N>
  BoundGlazing<N> bind(const Shading<N>& shading) const {
    return {this, shading.index_from, shading.wavelengths};
  }

  /// Of unpolarised light.
  Shares shares(double cosine, float index_from, float wavelength) const;
  /// A measured pane, of which nobody knows more, neither polarises nor depolarises.
  PolarisedLayers polarised(double cosine, float index_from, float wavelength) const;
  /// Probability of mirroring, the same for all wavelengths. Never 0 or 1: at some wavelength the
  /// average may be far off.
  float mirroring(float cosine) const;

 private:
  static constexpr std::size_t kAngles = 64;

  std::vector<Pane> panes_;
  /// At equally spaced cosines from 0 to 1, by the mean over wavelengths.
  std::array<float, kAngles + 1> mirroring_;
};

template <int N>
template <class F>
Spectral<N> BoundGlazing<N>::shares(Vec3 wo, const F& f) const {
  Spectral<N> r;
  for (std::size_t i = 0; i < N; ++i)
    r[i] = static_cast<float>(
        f(glazing->shares(static_cast<double>(wo.z), index_from[i], wavelengths[i])));
  return r;
}

template <int N>
Mueller<N> BoundGlazing<N>::mueller(Vec3 wo, Vec3 wi, std::uint32_t photons) const {
  Mueller<N> found;
  for (std::size_t i = 0; i < N; ++i) {
    if (((photons >> i) & 1u) == 0u) continue;
    const PolarisedLayers by =
        glazing->polarised(static_cast<double>(wo.z), index_from[i], wavelengths[i]);
    if (wi.z > 0.0f) {
      found.set(i, by.s.front, by.p.front, by.both.front);
    } else {
      found.set(i, by.s.through, by.p.through, by.both.through);
    }
  }
  return found;
}

template <int N>
std::optional<Draw<N>> BoundGlazing<N>::sample(Vec3 wo, const KernelNumbers& numbers,
                                               std::size_t) const {
  const float mirrors = glazing->mirroring(wo.z);
  const bool mirror = numbers.part < mirrors;
  const double less = 1.0 / static_cast<double>(mirror ? mirrors : 1.0f - mirrors);
  return Draw<N>{.wi = mirror ? Vec3{-wo.x, -wo.y, wo.z} : -wo,
                 .delta = true,
                 .factor = shares(
                     wo, [&](Shares s) { return less * (mirror ? s.reflected : s.transmitted); })};
}
static_assert(BoundKernel<BoundGlazing<1>, 1> && BoundKernel<BoundGlazing<4>, 4>);

}  // namespace nocturne

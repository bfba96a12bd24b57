// Thin films on a boundary: light that is reflected at all of their faces interferes. Layers are
// taken one after the other from the base outwards (Rouard's form of the transfer matrix: O. S.
// Heavens, Optical Properties of Thin Solid Films, 1955, section 4.5), in which waves only decay,
// so that no layer is too thick or too black, and one that is evanescent is as any other:
//   r = (r01 + r e^2id) / (1 + r01 r e^2id),  t = t01 t e^id / (1 + r01 r e^2id),
// d = 2 pi n cos(angle) thickness / wavelength. Indices are n + i k; waves go as e^(i k z).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "kernels/kernel.h"
#include "spectrum/spectrum.h"

namespace nocturne {

struct Complex {
  double re = 0.0, im = 0.0;

  friend Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
  friend Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
  friend Complex operator*(Complex a, Complex b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend Complex operator*(double a, Complex b) { return {a * b.re, a * b.im}; }
  friend Complex operator/(Complex a, Complex b) {
    const double less = 1.0 / b.norm();
    return {less * (a.re * b.re + a.im * b.im), less * (a.im * b.re - a.re * b.im)};
  }
  Complex conjugate() const { return {re, -im}; }
  /// |z|^2
  double norm() const { return re * re + im * im; }
};

/// Of the electric field, behind the boundary over that of the light that comes.
struct Amplitudes {
  Complex reflected, transmitted;
};
/// Across the plane of incidence, and in it; the sign of p is that of the magnetic field.
struct PolarisedAmplitudes {
  Amplitudes s, p;
};

/// Of a flux that comes.
struct Shares {
  double reflected, transmitted;
};
struct PolarisedShares {
  Shares s, p;

  Shares unpolarised() const {
    return {0.5 * (s.reflected + p.reflected), 0.5 * (s.transmitted + p.transmitted)};
  }
};

/// At one wavelength; thickness in nm.
struct FilmLayer {
  Complex index;
  double thickness;
};

/// Light comes from the index `from` > 0 at an angle of this cosine in [0, 1], goes through the
/// layers in turn, and on to the index `to`.
PolarisedAmplitudes film_amplitudes(double cosine, double from, std::span<const FilmLayer> layers,
                                    Complex to, double wavelength);
/// The same as shares; where `to` absorbs, the transmitted share is the one that enters it.
PolarisedShares film_shares(double cosine, double from, std::span<const FilmLayer> layers,
                            Complex to, double wavelength);

/// The layers on a boundary, for all wavelengths, in the order in which light meets them.
class ThinFilm {
 public:
  static constexpr std::size_t kMaxLayers = 64;

  struct Layer {
    /// Against vacuum.
    Spectrum n, k;
    /// nm
    double thickness;
  };

  ThinFilm() = default;
  /// Throws std::invalid_argument if there are more than kMaxLayers.
  explicit ThinFilm(std::vector<Layer> layers);

  bool empty() const { return layers_.empty(); }
  ThinFilm reversed() const;

  /// Of light that meets the layers in their order, or in reverse.
  PolarisedAmplitudes amplitudes(double cosine, double from, Complex to, float wavelength,
                                 bool in_reverse = false) const;
  PolarisedShares shares(double cosine, double from, Complex to, float wavelength,
                         bool in_reverse = false) const;

 private:
  // f(layers at this wavelength).
  template <class F>
  auto with_layers(float wavelength, bool in_reverse, const F& f) const;

  std::vector<Layer> layers_;
};

/// The film of a kernel at a vertex.
template <int N>
struct BoundThinFilm {
  /// Null where there is none.
  const ThinFilm* film = nullptr;
  /// Of refraction on the side of the light.
  Spectral<N> index_from = 1.0f, wavelengths = 0.0f;

  explicit operator bool() const { return film != nullptr; }

  /// Of unpolarised light on the boundary to n + i k, relative to `index_from`.
  Shares operator()(double cosine, std::size_t lane, double n, double k = 0.0) const {
    const auto from = static_cast<double>(index_from[lane]);
    return film->shares(cosine, from, {n * from, k * from}, wavelengths[lane]).unpolarised();
  }
  /// Of fields, also where there is no film.
  PolarisedAmplitudes amplitudes(double cosine, std::size_t lane, double n, double k = 0.0) const {
    if (film == nullptr) return film_amplitudes(cosine, 1.0, {}, {n, k}, 1.0);
    const auto from = static_cast<double>(index_from[lane]);
    return film->amplitudes(cosine, from, {n * from, k * from}, wavelengths[lane]);
  }
};

template <int N>
BoundThinFilm<N> bound_thin_film(const ThinFilm& film, const Shading<N>& shading) {
  if (film.empty()) return {};
  return {&film, shading.index_from, shading.wavelengths};
}

}  // namespace nocturne

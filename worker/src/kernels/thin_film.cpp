#include "kernels/thin_film.h"

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "math/functions.h"

namespace nocturne {
namespace {

// Of a wave that decays along its path: the imaginary part is not negative.
Complex root(Complex z) {
  const double size = std::sqrt(z.norm());
  const double larger = std::sqrt(0.5 * (size + std::fabs(z.re)));
  if (!(larger > 0.0)) return {};
  const double other = 0.5 * z.im / larger;
  if (z.re >= 0.0) return other < 0.0 ? Complex{-larger, -other} : Complex{larger, other};
  return z.im < 0.0 ? Complex{-std::fabs(other), larger} : Complex{std::fabs(other), larger};
}

// e^(i z)
Complex wave(Complex z) {
  const double size = math::exp(-z.im);
  return {size * math::cos(z.re), size * math::sin(z.re)};
}

// n^2 and n cos(angle) where the wave along the surface is `along`, n sin(angle).
struct Place {
  Complex square, normal;

  Place(Complex index, double along) : square(index * index) {
    normal = root({(index.re - along) * (index.re + along) - index.im * index.im, square.im});
    // Squares know no smaller difference, and a wave that runs exactly along a layer's faces would
    // be divided by zero.
    constexpr double kLeast = 1e-8;
    if (normal.norm() < kLeast * kLeast) normal = {kLeast, 0.0};
  }
};

struct Interface {
  Complex reflected, transmitted;
};

Interface across(const Place& a, const Place& b) {
  const Complex sum = a.normal + b.normal;
  return {(a.normal - b.normal) / sum, 2.0 * a.normal / sum};
}

// In the plane of incidence; `indices` is the product of both.
Interface within(const Place& a, const Place& b, Complex indices) {
  const Complex one = b.square * a.normal, other = a.square * b.normal, sum = one + other;
  return {(one - other) / sum, 2.0 * indices * a.normal / sum};
}

// A boundary that is reached through a layer, whose phase is e^(i d), behind an interface.
Amplitudes behind(const Interface& first, Complex phase, const Amplitudes& next) {
  const Complex back = phase * phase * next.reflected;
  const Complex sum = Complex{1.0} + first.reflected * back;
  return {(first.reflected + back) / sum, first.transmitted * phase * next.transmitted / sum};
}

}  // namespace

PolarisedAmplitudes film_amplitudes(double cosine, double from, std::span<const FilmLayer> layers,
                                    Complex to, double wavelength) {
  const double along = from * std::sqrt((1.0 - cosine) * (1.0 + cosine));
  // From the base outwards: `here` is the medium above the interface, `below` the one under it.
  Place below(to, along);
  Complex index_below = to;
  PolarisedAmplitudes found{};
  bool is_base = true;
  for (std::size_t i = layers.size() + 1; i-- > 0;) {
    const Complex index = i > 0 ? layers[i - 1].index : Complex{from};
    const Place here(index, along);
    const Interface s = across(here, below), p = within(here, below, index * index_below);
    if (is_base) {
      found = {{s.reflected, s.transmitted}, {p.reflected, p.transmitted}};
    } else {
      const Complex phase =
          wave((2.0 * std::numbers::pi * layers[i].thickness / wavelength) * below.normal);
      found = {behind(s, phase, found.s), behind(p, phase, found.p)};
    }
    is_base = false;
    below = here;
    index_below = index;
  }
  return found;
}

PolarisedShares film_shares(double cosine, double from, std::span<const FilmLayer> layers,
                            Complex to, double wavelength) {
  const double along = from * std::sqrt((1.0 - cosine) * (1.0 + cosine));
  const PolarisedAmplitudes found = film_amplitudes(cosine, from, layers, to, wavelength);
  const double here = Place({from}, along).normal.re;
  const Place there(to, along);
  // n cos, and the real part of n times the conjugate of cos: what flows along the normal.
  const Complex cosine_there = there.normal / to;
  const double flow_s = there.normal.re / here,
               flow_p = (to.re * cosine_there.re + to.im * cosine_there.im) / here;
  const auto share = [](double flow, const Amplitudes& a) {
    return Shares{a.reflected.norm(), std::max(0.0, flow) * a.transmitted.norm()};
  };
  return {share(flow_s, found.s), share(flow_p, found.p)};
}

ThinFilm::ThinFilm(std::vector<Layer> layers) : layers_(std::move(layers)) {
  if (layers_.size() > kMaxLayers) throw std::invalid_argument("a film of more than 64 layers");
}

ThinFilm ThinFilm::reversed() const { return ThinFilm({layers_.rbegin(), layers_.rend()}); }

template <class F>
auto ThinFilm::with_layers(float wavelength, bool in_reverse, const F& f) const {
  std::array<FilmLayer, kMaxLayers> layers;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const Layer& layer = layers_[in_reverse ? layers_.size() - 1 - i : i];
    layers[i] = {{layer.n(wavelength), layer.k(wavelength)}, layer.thickness};
  }
  return f(std::span<const FilmLayer>(layers).first(layers_.size()));
}

PolarisedAmplitudes ThinFilm::amplitudes(double cosine, double from, Complex to, float wavelength,
                                         bool in_reverse) const {
  return with_layers(wavelength, in_reverse, [&](std::span<const FilmLayer> layers) {
    return film_amplitudes(std::clamp(cosine, 0.0, 1.0), from, layers, to, wavelength);
  });
}

PolarisedShares ThinFilm::shares(double cosine, double from, Complex to, float wavelength,
                                 bool in_reverse) const {
  return with_layers(wavelength, in_reverse, [&](std::span<const FilmLayer> layers) {
    return film_shares(std::clamp(cosine, 0.0, 1.0), from, layers, to, wavelength);
  });
}

}  // namespace nocturne

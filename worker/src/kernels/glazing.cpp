#include "kernels/glazing.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "math/functions.h"

namespace nocturne {
namespace {

/// Of both polarisations.
struct Polarised {
  LayerShares s, p;

  Polarised turned() const { return {s.turned(), p.turned()}; }
};

Polarised one_behind_other(const Polarised& first, const Polarised& second, double between = 1.0) {
  return {nocturne::one_behind_other(first.s, second.s, between),
          nocturne::one_behind_other(first.p, second.p, between)};
}

/// `film` between two indices, as it is met.
Polarised face(const ThinFilm& film, double cosine, double from, double to, float wavelength) {
  const double ratio = to / from;
  const double g2 = (ratio - 1.0) * (ratio + 1.0) + cosine * cosine;
  const PolarisedShares front = film.shares(cosine, from, {to}, wavelength);
  if (g2 <= 0.0) return {{front.s.reflected, 1.0, 0.0}, {front.p.reflected, 1.0, 0.0}};
  const PolarisedShares back = film.shares(std::sqrt(g2) / ratio, to, {from}, wavelength, true);
  return {{front.s.reflected, back.s.reflected, front.s.transmitted},
          {front.p.reflected, back.p.reflected, front.p.transmitted}};
}

// The effect of a boundary on products of fields. It ends light that it reflects totally.
LayerProducts product_face(const ThinFilm& film, double cosine, double from, double to,
                           float wavelength) {
  const double ratio = to / from;
  const double g2 = (ratio - 1.0) * (ratio + 1.0) + cosine * cosine;
  const PolarisedAmplitudes front = film.amplitudes(cosine, from, {to}, wavelength);
  const auto product = [](Complex s, Complex p) { return s * p.conjugate(); };
  const Complex mirrored = product(front.s.reflected, front.p.reflected);
  if (g2 <= 0.0) return {mirrored, {}, {}};
  const PolarisedAmplitudes back =
      film.amplitudes(std::sqrt(g2) / ratio, to, {from}, wavelength, true);
  // The flux along the normal: n cos beyond over n cos here.
  const double flow = std::sqrt(g2) / cosine;
  return {mirrored, product(back.s.reflected, back.p.reflected),
          flow * product(front.s.transmitted, front.p.transmitted)};
}

LayerProducts one_behind_other(const LayerProducts& first, const LayerProducts& second,
                               double between) {
  const double there_and_back = between * between;
  const Complex echo = Complex{1.0} - there_and_back * (first.back * second.front);
  if (!(echo.norm() > 0.0)) return {first.front, second.back, {}};
  return {first.front + there_and_back * (first.through * first.through * second.front) / echo,
          second.back + there_and_back * (second.through * second.through * first.back) / echo,
          between * (first.through * second.through) / echo};
}

// Two faces and what is between: `face` is that of a film between two indices, as it is met.
template <class Layer>
Layer sheet(const SheetPane& pane, double cosine, double index_from, float wavelength,
            Layer (*face)(const ThinFilm&, double, double, double, float)) {
  const auto index = static_cast<double>(pane.index(wavelength));
  const double ratio = index / index_from;
  const double g2 = (ratio - 1.0) * (ratio + 1.0) + cosine * cosine;
  const Layer front = face(pane.front, cosine, index_from, index, wavelength);
  const Layer back = face(pane.back, cosine, index_from, index, wavelength).turned();
  if (g2 <= 0.0) return one_behind_other(front, back, 0.0);
  const auto transmittance = static_cast<double>(pane.transmittance(wavelength));
  const double between =
      transmittance == 1.0 ? 1.0 : math::pow(transmittance, ratio / std::sqrt(g2));
  return one_behind_other(front, back, between);
}

struct At {
  double cosine, index_from;
  float wavelength;

  Polarised operator()(const SheetPane& pane) const {
    return sheet(pane, cosine, index_from, wavelength, face);
  }
  Polarised operator()(const FilmPane& pane) const {
    return face(pane.film, cosine, index_from, index_from, wavelength);
  }
  Polarised operator()(const MeasuredPane& pane) const {
    const LayerShares found = measured_shares(
        {static_cast<double>(pane.front(wavelength)), static_cast<double>(pane.back(wavelength)),
         static_cast<double>(pane.transmittance(wavelength))},
        cosine);
    return {found, found};
  }
};

struct ProductsAt {
  double cosine, index_from;
  float wavelength;

  LayerProducts operator()(const SheetPane& pane) const {
    return sheet(pane, cosine, index_from, wavelength, product_face);
  }
  LayerProducts operator()(const FilmPane& pane) const {
    return product_face(pane.film, cosine, index_from, index_from, wavelength);
  }
  // As along the normal, where a mirror turns the field in the plane of incidence around.
  LayerProducts operator()(const MeasuredPane& pane) const {
    const LayerShares found = At{cosine, index_from, wavelength}(pane).s;
    return {{-found.front}, {-found.back}, {found.through}};
  }
};

double polynomial(const std::array<double, 5>& c, double x) {
  return c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4])));
}

}  // namespace

LayerShares one_behind_other(const LayerShares& first, const LayerShares& second, double between) {
  const double there_and_back = between * between;
  const double echo = 1.0 - first.back * second.front * there_and_back;
  // Between two perfect mirrors, where nothing comes in.
  if (!(echo > 0.0)) return {first.front, second.back, 0.0};
  return {first.front + first.through * first.through * there_and_back * second.front / echo,
          second.back + second.through * second.through * there_and_back * first.back / echo,
          first.through * between * second.through / echo};
}

LayerShares measured_shares(const LayerShares& along_normal, double cosine) {
  struct Fit {
    std::array<double, 5> transmitted, both;
  };
  constexpr double kClear = 0.645;
  static constexpr Fit kOfClear{{-0.0015, 3.355, -3.840, 1.460, 0.0288},
                                {0.999, -0.563, 2.043, -2.532, 1.054}};
  static constexpr Fit kOfBronze{{-0.002, 2.813, -2.341, -0.05725, 0.599},
                                 {0.997, -1.868, 6.513, -7.862, 3.225}};
  const Fit& fit = along_normal.through > kClear ? kOfClear : kOfBronze;
  const auto of = [&](const std::array<double, 5>& c) {
    return std::clamp(polynomial(c, cosine) / polynomial(c, 1.0), 0.0, 1.0);
  };
  const double t = of(fit.transmitted), r = std::clamp(of(fit.both) - t, 0.0, 1.0 - t);
  const auto reflected = [&](double normal) { return normal * (1.0 - r) + r; };
  const double through = along_normal.through * t;
  return {std::min(reflected(along_normal.front), 1.0 - through),
          std::min(reflected(along_normal.back), 1.0 - through), through};
}

Glazing::Glazing(std::vector<Pane> panes) : panes_(std::move(panes)) {
  if (panes_.empty()) throw std::invalid_argument("a glazing without panes");
  constexpr int kWavelengths = 24;
  constexpr float kFirst = 380.0f, kStep = 15.0f, kLeast = 0x1p-8f;
  for (std::size_t i = 0; i <= kAngles; ++i) {
    const double cosine = static_cast<double>(i) / static_cast<double>(kAngles);
    double reflected = 0.0, all = 1e-30;
    for (int j = 0; j < kWavelengths; ++j) {
      const Shares found = shares(cosine, 1.0f, kFirst + kStep * static_cast<float>(j));
      reflected += found.reflected;
      all += found.reflected + found.transmitted;
    }
    mirroring_[i] = std::clamp(static_cast<float>(reflected / all), kLeast, 1.0f - kLeast);
  }
}

PolarisedLayers Glazing::polarised(double cosine, float index_from, float wavelength) const {
  // Along the faces no flux goes through them.
  constexpr double kLeast = 1e-9;
  cosine = std::clamp(cosine, kLeast, 1.0);
  const At at{cosine, static_cast<double>(index_from), wavelength};
  const ProductsAt products_at{cosine, at.index_from, wavelength};
  Polarised all = std::visit(at, panes_[0]);
  LayerProducts products = std::visit(products_at, panes_[0]);
  for (std::size_t i = 1; i < panes_.size(); ++i) {
    all = one_behind_other(all, std::visit(at, panes_[i]));
    products = one_behind_other(products, std::visit(products_at, panes_[i]), 1.0);
  }
  return {all.s, all.p, products};
}

Shares Glazing::shares(double cosine, float index_from, float wavelength) const {
  const At at{std::clamp(cosine, 0.0, 1.0), static_cast<double>(index_from), wavelength};
  Polarised all = std::visit(at, panes_[0]);
  for (std::size_t i = 1; i < panes_.size(); ++i)
    all = one_behind_other(all, std::visit(at, panes_[i]));
  return {0.5 * (all.s.front + all.p.front), 0.5 * (all.s.through + all.p.through)};
}

float Glazing::mirroring(float cosine) const {
  const float place = std::clamp(cosine, 0.0f, 1.0f) * static_cast<float>(kAngles);
  const auto cell = std::min(static_cast<std::size_t>(place), kAngles - 1);
  const float t = place - static_cast<float>(cell);
  return mirroring_[cell] + t * (mirroring_[cell + 1] - mirroring_[cell]);
}

}  // namespace nocturne

#include "kernels/thin_pane.h"

#include "kernels/thin_film.h"
#include "math/functions.h"

namespace nocturne {

PaneShares pane_shares(double cosine, double ratio, double transmittance) {
  cosine = std::clamp(cosine, 0.0, 1.0);
  const double r = fresnel_dielectric(cosine, ratio);
  if (r >= 1.0) return {1.0, 0.0};
  const double g2 = (ratio - 1.0) * (ratio + 1.0) + cosine * cosine;
  const double way = g2 > 0.0 ? ratio / std::sqrt(g2) : 1.0;  // 1 / cos of the refracted angle
  const double t = transmittance == 1.0 ? 1.0 : math::pow(transmittance, way);
  const double through = (1.0 - r) * (1.0 - r) * t / (1.0 - r * r * t * t);
  return {r * (1.0 + through * t), through};
}

PolarisedPane polarised_pane(double cosine, double ratio, double transmittance) {
  cosine = std::clamp(cosine, 0.0, 1.0);
  const double g2 = (ratio - 1.0) * (ratio + 1.0) + cosine * cosine;
  // Total reflection turns the phases apart; at a pane's two faces that is next to nothing.
  if (g2 <= 0.0) return {{1.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}};
  const PolarisedAmplitudes face = film_amplitudes(cosine, 1.0, {}, {ratio}, 1.0);
  const double t = transmittance == 1.0 ? 1.0 : math::pow(transmittance, ratio / std::sqrt(g2));
  // Of the product of two fields, which a face multiplies by these.
  const auto sum = [t](double one, double other) {
    const double r = one * other, twice = (1.0 - one * one) * (1.0 - other * other);
    const double through = twice * t / (1.0 - r * r * t * t);
    return PaneShares{r * (1.0 + through * t), through};
  };
  const double s = face.s.reflected.re, p = face.p.reflected.re;
  return {sum(s, s), sum(p, p), sum(s, p)};
}

}  // namespace nocturne

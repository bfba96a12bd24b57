#include "kernels/thin_pane.h"

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

}  // namespace nocturne

// Scattering by molecules, of unpolarised light: 3 / (16 pi (1 + 2 gamma)) x (1 + 3 gamma + (1 -
// gamma) cos^2), gamma = depolarisation / (2 - depolarisation). Bucholtz, "Rayleigh-scattering
// calculations for the terrestrial atmosphere", Applied Optics 34(15), 1995, equations 12 and 13,
// after Chandrasekhar, Radiative Transfer, 1950.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "kernels/kernel.h"
#include "kernels/mueller.h"
#include "kernels/scattering_angle.h"
#include "math/functions.h"
#include "spectrum/spectrum.h"

namespace nocturne {

/// A share of photons scatters as cos^2, the others evenly: (1 - share + 3 share cos^2) / (4 pi).
template <int N>
struct BoundRayleigh {
  Spectral<N> share;
  float mean_share;

  Spectral<N> density(const ScatteringAngle& angle) const {
    const float c = static_cast<float>(angle.cosine());
    return each([&](float s) { return density(s, c); }, share);
  }
  float mean_density(const ScatteringAngle& angle) const {
    return density(mean_share, static_cast<float>(angle.cosine()));
  }
  /// Hansen and Travis, "Light scattering in planetary atmospheres", Space Science Reviews 16,
  /// 1974, equations 2.15 and 2.16; the direction is across the plane of scattering.
  Mueller<N> mueller(const ScatteringAngle& angle) const {
    const float cosine = static_cast<float>(angle.cosine());
    const Spectral<N> even = Spectral<N>(1.0f) - share, three = 3.0f * share;
    const Spectral<N> inverse = Spectral<N>(1.0f) / (even + cosine * cosine * three);
    const Spectral<N> part = three * inverse;
    Mueller<N> found;
    found.b = (1.0f - cosine) * (1.0f + cosine) * part;
    found.a = (1.0f + cosine * cosine) * part;
    found.c = 2.0f * cosine * part;
    // delta = (1 - 4 share) / (1 + 2 share); (1 - 2 delta) / (1 - delta)
    found.d = found.c * each([](float s) { return (10.0f * s - 1.0f) / (6.0f * s); }, share);
    return found;
  }
  /// By inversion: the real root of share c^3 + (1 - share) c = 2 u - 1, by Viete's hyperbolic
  /// form.
  ScatteringAngle sample(const KernelNumbers& numbers) const {
    const float p = (1.0f - mean_share) / (3.0f * mean_share);
    const float q = (2.0f * numbers.u - 1.0f) / (2.0f * mean_share);
    const float root = std::sqrt(p);
    const float c = 2.0f * root * math::sinh(math::asinh(q / (p * root)) / 3.0f);
    return ScatteringAngle::from_cosine(std::clamp(c, -1.0f, 1.0f));
  }

 private:
  static float density(float share, float cosine) {
    return 0.25f * kInvPi * (1.0f - share + 3.0f * share * cosine * cosine);
  }
};

class RayleighPhase {
 public:
  /// Depolarisation ratio for natural light, in [0, 1); none: 0. Throws std::invalid_argument where
  /// it is negative; what reaches 1 is held just below, where nothing is left but even scattering.
  explicit RayleighPhase(std::optional<Spectrum> depolarisation)
      : depolarisation_(std::move(depolarisation)) {
    if (depolarisation_ && !(depolarisation_->least() >= 0.0f)) {
      throw std::invalid_argument("a negative depolarisation ratio");
    }
  }

  template <int N>
  BoundRayleigh<N> bind(const Shading<N>& shading) const& {
    BoundRayleigh<N> bound{0.25f, 0.25f};
    if (depolarisation_) {
      // (1 - gamma) / (4 (1 + 2 gamma))
      bound.share = each(
          [](float d) { return 0.5f * (1.0f - d) / (2.0f + d); },
          each([](float d) { return std::min(d, kMax); }, (*depolarisation_)(shading.wavelengths)));
      bound.mean_share = sum(shading.path_pdf_ratio * bound.share);
    }
    return bound;
  }

 private:
  static constexpr float kMax = 1.0f - 1e-6f;

  std::optional<Spectrum> depolarisation_;
};

}  // namespace nocturne

// A disc at infinity such as the Sun: uniform, or darker towards its limb.
#pragma once

#include <cstdint>
#include <vector>

#include "luminaires/hidden_from.h"
#include "math/frame.h"
#include "math/vec3.h"
#include "spectrum/spectrum.h"

namespace nocturne {

class DistantDisc {
 public:
  /// Radiance over that at the centre is the sum of (plus[k] - minus[k]) mu^k, mu = cosine of the
  /// angle between the line of sight and the normal of the star's surface. Both empty: 1.
  struct LimbDarkening {
    std::vector<Spectrum> plus, minus;
  };

  /// Unit direction towards the disc; angular radius in (0, pi/2]; radiance at its centre, W m-2
  /// sr-1 nm-1. Throws std::invalid_argument.
  DistantDisc(Vec3 direction, double half_angle, Spectrum radiance, LimbDarkening limb = {});

  HiddenFrom hidden_from = HiddenFrom::kNobody;
  std::uint32_t light_group = 0;

  Vec3 direction() const { return frame_.normal; }

  /// Of its angular radius; very large for half the sky.
  float tan_half_angle() const { return sin_ / (1.0f - wide_drop_); }

  /// From the unit direction; zero outside the disc, never negative.
  template <int N>
  Spectral<N> radiance(Vec3 direction, const Spectral<N>& wavelengths) const {
    const float drop = drop_to(direction);
    if (drop > drop_) return 0.0f;
    Spectral<N> result = radiance_(wavelengths);
    if (!limb_.plus.empty() || !limb_.minus.empty()) result *= limb(drop, wavelengths);
    return result;
  }

  /// A unit direction to the disc, uniform over solid angle (and a rim of half a microradian, see
  /// kDirectionRounding).
  Vec3 sample(float u1, float u2) const;

  /// Density of `sample`, 1/sr.
  float pdf(Vec3 direction) const { return drop_to(direction) <= wide_drop_ ? density_ : 0.0f; }

  /// Of a surface with that unit normal, on one side or both, averaged over visible wavelengths:
  /// not zero wherever any of the disc is above the horizon. W m-2 nm-1; an estimate for choices.
  float irradiance(Vec3 normal, bool both_sides) const;

 private:
  // 1 - cosine of the angle to the axis, without cancellation.
  float drop_to(Vec3 direction) const {
    const Vec3 chord = direction - frame_.normal;
    return 0.5f * dot(chord, chord);
  }

  template <int N>
  Spectral<N> limb(float drop, const Spectral<N>& wavelengths) const {
    const float sin2 = drop * (2.0f - drop) * inverse_sin2_;
    const float mu = std::sqrt(std::max(0.0f, 1.0f - sin2));
    Spectral<N> total = 0.0f;
    float power = 1.0f;
    for (std::size_t k = 0; k < std::max(limb_.plus.size(), limb_.minus.size()); ++k) {
      if (k < limb_.plus.size()) total += power * limb_.plus[k](wavelengths);
      if (k < limb_.minus.size()) total += -power * limb_.minus[k](wavelengths);
      power *= mu;
    }
    return each([](float x) { return std::max(0.0f, x); }, total);
  }

  Frame frame_;  // around the direction
  Spectrum radiance_;
  LimbDarkening limb_;
  float drop_, wide_drop_;  // 1 - cosine of the half angle; of that which is sampled
  float inverse_sin2_;
  float sin_;  // of the half angle that is sampled
  float density_;
  float perpendicular_;  // irradiance at normal incidence, for choices
};

}  // namespace nocturne

// Small bright lamps as if each filled a cone: how much of their light a photon's direction nearly
// meets. What mirrors and glass turn at random meets a lamp of a millimetre once in a million times
// and its cone once in a hundred, and brings the same light on average. Pictures lose their edges,
// so that only a pilot counts by these: it tells where in the image such light may be.
//
// Kaplanyan and Dachsbacher, "Path Space Regularization for Holistic and Robust Light Transport",
// Computer Graphics Forum 32 (2), 2013, section 4: a delta distribution as a narrow cone.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "luminaires/light_directions.h"
#include "luminaires/luminaire.h"
#include "math/constants.h"

namespace nocturne {

class WidenedLamps {
 public:
  /// None.
  WidenedLamps() = default;
  /// Those of a radiance of `least` or more, W m-2 sr-1 nm-1, the Sun in a picture of the sky too.
  WidenedLamps(const LightDirections& lights, std::span<const Luminaire> luminaires, float least);

  bool empty() const { return discs_.empty() && sky_.empty() && elements_.empty(); }
  /// W m-2 sr-1 nm-1, mean over wavelengths; 0 where there are none.
  float brightest() const { return brightest_; }

  /// Radiance of the widened lamps on a half-line that is free for `distance`, m, and then meets
  /// the luminaire `met`, Emission::kNoLuminaire where it meets none.
  template <int N>
  Spectral<N> radiance(const LightDirections& lights, Vec3 origin, Vec3 direction, float distance,
                       std::uint32_t met, const Spectral<N>& wavelengths_nm) const {
    Spectral<N> found = 0.0f;
    if (std::isinf(distance)) {
      for (const Disc& each : discs_) {
        const DistantDisc& disc = lights.discs()[each.index];
        if (dot(disc.direction(), direction) < kCosine) continue;
        found += each.part_of_cone * disc.radiance(disc.direction(), wavelengths_nm);
      }
    }
    float near = 0.0f;
    if (std::isinf(distance)) {
      for (const Sky& each : sky_)
        near += dot(each.direction, direction) < kCosine ? 0.0f : each.radiance;
    }
    for (const Element& each : elements_) near += of(each, origin, direction, distance, met);
    return found + Spectral<N>(near);
  }

 private:
  void add_sky(const Environment& environment, float least);

  /// Half angle of the cone: 11 degrees. Its solid angle is a hundredth of the sphere's, so that of
  /// a pilot's thousands of photons some meet it.
  static constexpr float kCosine = 0.98f, kCone = kTwoPi * (1.0f - kCosine);
  /// Of more elements every so many is taken for those beside it.
  static constexpr std::size_t kMostElements = 64;

  struct Disc {
    std::uint32_t index;
    float part_of_cone;
  };
  /// A bright part of the environment, of which so many are drawn by its radiance.
  static constexpr int kSkyDraws = 64;
  struct Sky {
    Vec3 direction;
    float radiance;
  };
  struct Element {
    Vec3 place;
    /// Intensity along the axis, W/(sr nm).
    float intensity;
    Vec3 axis;
    float cosine_power;
    bool to_all_sides, two_sided;
    std::uint32_t luminaire;
    float radiance;
  };
  static float of(const Element& lamp, Vec3 origin, Vec3 direction, float distance,
                  std::uint32_t met);

  float brightest_ = 0.0f;
  std::vector<Disc> discs_;
  std::vector<Sky> sky_;
  std::vector<Element> elements_;
};

}  // namespace nocturne

// A surface that emits: spectral radiance, W m-2 sr-1 nm-1, the same in all directions of the
// emitting side(s) or times an angular profile.
#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <variant>

#include "luminaires/elements.h"
#include "luminaires/hidden_from.h"
#include "luminaires/intensity_profile.h"
#include "math/constants.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "parameters/colour.h"

namespace nocturne {

/// The same radiance in all directions.
struct LambertianProfile {};

/// Radiance times cos^power of the angle to the normal.
struct CosinePowerProfile {
  float power;
};

/// Radiance is the intensity over the projected area, seen from its direction, of the whole shape,
/// which is flat or a sphere. Directions are those of the scene.
struct IntensityLamp {
  IntensityProfile intensity;
  /// m2: of a flat shape on one side; of a sphere its cross-section, pi r^2.
  float area;
  bool flat;
};

using AngularProfile = std::variant<LambertianProfile, CosinePowerProfile, IntensityLamp>;

class Luminaire {
 public:
  /// `surface`: index of the surface that emits. Throws std::invalid_argument where a profile's
  /// power is negative or its area not positive.
  Luminaire(std::uint32_t surface_index, Colour radiance, bool two_sided,
            AngularProfile profile = LambertianProfile{})
      : surface(surface_index),
        radiance_(std::move(radiance)),
        two_sided_(two_sided),
        profile_(std::move(profile)) {
    const auto* cosine = std::get_if<CosinePowerProfile>(&profile_);
    if (cosine && !(cosine->power >= 0.0f && std::isfinite(cosine->power))) {
      throw std::invalid_argument("a luminaire's cosine power is negative or not finite");
    }
    const auto* lamp = std::get_if<IntensityLamp>(&profile_);
    if (lamp && !(lamp->area > 0.0f && std::isfinite(lamp->area))) {
      throw std::invalid_argument("a lamp with an intensity profile has no area");
    }
  }

  std::uint32_t surface;
  HiddenFrom hidden_from = HiddenFrom::kNobody;
  /// See light_group in scene.proto.
  std::uint32_t light_group = 0;

  bool two_sided() const { return two_sided_; }
  /// Whether `emitted` looks at the surface point.
  bool textured() const { return radiance_.textured(); }

  /// Radiance at the wavelengths (nm), at a point with that normal (unit), towards `away` (unit,
  /// away from the surface).
  template <int N>
  Spectral<N> emitted(Vec3 normal, Vec3 away, const SurfacePoint& point,
                      const Spectral<N>& wavelengths) const {
    const float cosine = dot(normal, away);
    if (cosine <= 0.0f && !two_sided_) return 0.0f;
    const Spectral<N> radiance = radiance_(point, wavelengths);
    if (std::holds_alternative<LambertianProfile>(profile_)) return radiance;
    return profile(std::fabs(cosine), away) * radiance;
  }

  /// Whether anything is emitted from there towards `away`, at whichever wavelengths; as of
  /// `emitted`.
  bool emits(Vec3 normal, Vec3 away, const SurfacePoint& point) const {
    const float cosine = dot(normal, away);
    if (cosine <= 0.0f && !two_sided_) return false;
    if (radiance_.dark(point)) return false;
    return std::holds_alternative<LambertianProfile>(profile_) ||
           profile(std::fabs(cosine), away) > 0.0f;
  }

  /// What directions towards this luminaire go by.
  Emission emission() const {
    const float mean = radiance_.mean();
    if (const auto* cosine = std::get_if<CosinePowerProfile>(&profile_)) {
      return {mean, two_sided_, cosine->power};
    }
    if (const auto* lamp = std::get_if<IntensityLamp>(&profile_)) {
      // As a Lambertian surface of the same flux, from wherever it is seen.
      const auto flux = static_cast<float>(lamp->intensity.flux());
      return {mean * flux / (kPi * lamp->area), two_sided_, Emission::kAnyDirection};
    }
    return {mean, two_sided_, 0.0f};
  }

 private:
  float profile(float cosine, Vec3 away) const {
    if (const auto* power = std::get_if<CosinePowerProfile>(&profile_)) {
      return math::pow(cosine, power->power);
    }
    const auto& lamp = std::get<IntensityLamp>(profile_);
    const float projected = lamp.flat ? lamp.area * cosine : lamp.area;
    // A flat lamp seen edge-on has no area to divide by, and sends nothing.
    return projected > 1e-6f * lamp.area ? lamp.intensity(away) / projected : 0.0f;
  }

  Colour radiance_;
  bool two_sided_;
  AngularProfile profile_;
};

}  // namespace nocturne

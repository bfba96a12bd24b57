// Small bright lamps as if each filled a cone: how much of their light a photon's direction nearly
// meets. What mirrors and glass turn at random meets a lamp of a millimetre once in a million times
// and its cone once in a hundred, and brings the same light on average. Pictures lose their edges,
// so that only a pilot counts by these: it tells where in the image such light may be.
//
// Kaplanyan and Dachsbacher, "Path Space Regularization for Holistic and Robust Light Transport",
// Computer Graphics Forum 32 (2), 2013, section 4: a delta distribution as a narrow cone.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "luminaires/light_sampler.h"
#include "luminaires/luminaire.h"
#include "math/constants.h"

namespace nocturne {

class WidenedLamps {
 public:
  /// None.
  WidenedLamps() = default;
  /// Those of a radiance of `least` or more, W m-2 sr-1 nm-1, the Sun in a picture of the sky too.
  WidenedLamps(const LightSampler& lights, std::span<const Luminaire> luminaires, float least);

  bool empty() const { return discs_.empty() && sky_.empty() && elements_.empty(); }

  /// Of the dimmest of them, W m-2 sr-1 nm-1; infinite where there are none.
  float least_radiance() const {
    float least = std::numeric_limits<float>::infinity();
    for (const auto* distant : {&discs_, &sky_}) {
      for (const Distant& each : *distant) least = std::min(least, each.radiance);
    }
    for (const Element& each : elements_) least = std::min(least, each.radiance);
    return least;
  }

  /// Of the lamps that `reaches(hidden_from, direction, distance)`: whether they can be seen so far
  /// off, m, from the origin.
  struct Met {
    /// Radiance of the widened lamps, W m-2 sr-1 nm-1: the mean that photons meet that hit a
    /// lamp, or miss it, by chance; and the mean of its square.
    float mean = 0.0f, square = 0.0f;
  };
  template <class Reaches>
  Met met(Vec3 origin, Vec3 direction, const Reaches& reaches) const {
    Met found;
    const auto add = [&](float radiance, float part) {
      found.mean += part * radiance;
      found.square += part * radiance * radiance;
    };
    constexpr float kFar = std::numeric_limits<float>::infinity();
    for (const auto* distant : {&discs_, &sky_}) {
      for (const Distant& each : *distant) {
        if (dot(each.direction, direction) < kCosine) continue;
        if (reaches(each.hidden_from, each.direction, kFar)) add(each.radiance, each.part_of_cone);
      }
    }
    for (const Element& each : elements_) {
      const Vec3 there = each.place - origin;
      const float squared = dot(there, there), along = dot(there, direction);
      if (!(along > 0.0f) || along * along < kCosine * kCosine * squared) continue;
      const float part = part_of_cone(each, there, squared);
      if (!(part > 0.0f)) continue;
      const float distance = std::sqrt(squared);
      const float before = std::max(0.0f, distance - each.radius - kShort * distance);
      if (reaches(each.hidden_from, (1.0f / distance) * there, before)) add(each.radiance, part);
    }
    return found;
  }

 private:
  /// Half angle of the cone: 11 degrees. Its solid angle is a hundredth of the sphere's, so that of
  /// a pilot's thousands of photons some meet it.
  static constexpr float kCosine = 0.98f, kCone = kTwoPi * (1.0f - kCosine);
  /// Points of all elements; of more elements every so many is taken for its neighbours.
  static constexpr std::size_t kPoints = 64;
  /// Bright parts of the environment that are drawn by its radiance.
  static constexpr int kSkyDraws = 64;
  /// Part of the distance to a lamp that may be hidden.
  static constexpr float kShort = 1e-3f;

  struct Distant {
    Vec3 direction;
    float radiance, part_of_cone;
    HiddenFrom hidden_from;
  };
  struct Element {
    Vec3 place;
    /// Of a sphere, m.
    float radius;
    /// Intensity along the axis, W/(sr nm).
    float intensity;
    Vec3 axis;
    float cosine_power;
    bool to_all_sides, two_sided;
    float radiance;
    HiddenFrom hidden_from;
  };
  void add_sky(const Environment& environment, float least);
  void add_elements(const Elements& all, std::span<const Luminaire> luminaires, float least);
  static float part_of_cone(const Element& lamp, Vec3 there, float squared);

  std::vector<Distant> discs_, sky_;
  std::vector<Element> elements_;
};

}  // namespace nocturne

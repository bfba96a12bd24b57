// Where a ray leaves the surface that it met, without a step: the point itself, in more digits than
// a float has, and the primitive that is not to be met again.
#pragma once

#include <cstdint>

#include "math/double3.h"
#include "math/ray.h"

namespace nocturne {

struct Departure {
  static constexpr std::uint32_t kNothing = ~0u;

  /// From the ray's origin to where it starts, m: what rounding took.
  Vec3 residual = {0.0f, 0.0f, 0.0f};
  /// The primitive it leaves, as in Hit, or left before it met a medium; kNothing where it left
  /// nothing.
  std::uint32_t surface = kNothing, instance = kNothing, primitive = 0;
  /// It starts within a medium.
  bool in_medium = false;
  /// False: the ray starts at its origin, off the surface that it left, and nothing is left out.
  bool exact = false;

  Double3 start(const Ray& ray) const { return Double3(ray.origin) + Double3(residual); }
};

/// A ray from an exact point.
struct DepartingRay {
  Ray ray;
  Departure departure;

  static DepartingRay from(Double3 point, Vec3 direction) {
    const Vec3 residual{rounded_off(point.x), rounded_off(point.y), rounded_off(point.z)};
    return {{point.rounded(), direction}, {.residual = residual, .exact = true}};
  }

 private:
  // Volatile: GCC 12 takes the conversion of a pair of numbers to float and back for no change at
  // all.
  static float rounded_off(double exact) {
    const volatile float rounded = static_cast<float>(exact);
    return static_cast<float>(exact - double{rounded});
  }
};

}  // namespace nocturne

// Elements of luminaires on a half-line.
#pragma once

#include <limits>

#include "math/vec3.h"

namespace nocturne {

/// What a half-line from a point finds of an element.
struct OnHalfLine {
  /// Density of directions drawn towards it, 1/sr; 0: it is not there.
  float pdf = 0.0f;
  /// m; infinite where rounding has drawn a direction that just misses it.
  float distance = std::numeric_limits<float>::infinity();
};

/// A direction drawn towards an element, and the density of such draws, 1/sr: `pdf` of the
/// direction as it was rounded may miss the element at its rim.
struct DrawnDirection {
  Vec3 direction;
  float pdf;
};

/// Where the half-line meets it.
struct ElementPoint {
  /// Unit, on the side that emits.
  Vec3 normal;
  /// How far in front of it a ray along the normal must end so that it does not meet it, m.
  float clearance;
};

/// A direction drawn towards an element, and the values found there.
struct ElementSample {
  Vec3 direction;
  /// Density of such draws, 1/sr.
  float pdf;
  /// m; infinite where rounding has drawn one that just misses the element.
  float distance;
  ElementPoint point;
};

}  // namespace nocturne

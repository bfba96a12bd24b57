// How dense a medium can be along a ray, which delta tracking asks: Woodcock et al., "Techniques
// used in the GEM code for Monte Carlo neutronics calculations", ANL-7050, 1965.
//
// Every density has `float at(Vec3) const` and a walk `Bounds(density, ray, end)` whose segments
// tile [0, end). A bound holds where a position along the ray is rounded to single precision, too.
#pragma once

#include <utility>

#include "math/ray.h"

namespace nocturne {

/// From the end of the segment before, or 0, up to `end`, along the ray.
struct BoundSegment {
  float end;
  /// At least the density anywhere in the segment; 0 where there is nothing.
  float most;
};

class ConstantBounds;

struct ConstantDensity {
  using Bounds = ConstantBounds;
  /// Not negative.
  float value;

  float at(Vec3) const { return value; }
};

class ConstantBounds {
 public:
  ConstantBounds(const ConstantDensity& density, const Ray&, float end)
      : segment_{end, density.value}, left_(end > 0.0f) {}

  bool next(BoundSegment& segment) {
    segment = segment_;
    return std::exchange(left_, false);
  }

 private:
  BoundSegment segment_;
  bool left_;
};

}  // namespace nocturne

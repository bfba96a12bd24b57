// How dense a medium can be along a ray, which delta tracking asks: Woodcock et al., "Techniques
// used in the GEM code for Monte Carlo neutronics calculations", ANL-7050, 1965.
//
// Every density has a walk `Majorants(density, ray, end)`, whose segments tile [0, end), and which
// tells the density at a distance along the ray.
#pragma once

#include <optional>
#include <utility>

#include "math/ray.h"

namespace nocturne {

/// From the end of the segment before, or 0, up to `end`, along the ray.
struct MajorantSegment {
  float end;
  /// At least the density anywhere in the segment; 0 where there is nothing.
  float majorant;
};

/// Makes one segment of neighbours where there is nothing.
class EmptySpace {
 public:
  /// `advance` is what `next` would be without it.
  template <class Advance>
  bool next(MajorantSegment& segment, const Advance& advance) {
    if (ahead_) {
      segment = *std::exchange(ahead_, std::nullopt);
    } else if (!advance(segment)) {
      return false;
    }
    MajorantSegment after;
    while (segment.majorant == 0.0f && advance(after)) {
      if (after.majorant > 0.0f) {
        ahead_ = after;
        break;
      }
      segment.end = after.end;
    }
    return true;
  }

 private:
  std::optional<MajorantSegment> ahead_;
};

class ConstantMajorants;

struct ConstantDensity {
  using Majorants = ConstantMajorants;
  /// Not negative.
  float value;
};

class ConstantMajorants {
 public:
  ConstantMajorants(const ConstantDensity& density, const Ray&, float end)
      : segment_{end, density.value}, left_(end > 0.0f) {}

  float density(float) const { return segment_.majorant; }
  bool next(MajorantSegment& segment) {
    segment = segment_;
    return std::exchange(left_, false);
  }

 private:
  MajorantSegment segment_;
  bool left_;
};

}  // namespace nocturne

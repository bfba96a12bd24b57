// Where photons of distant light enter a scene: anywhere on a disc that faces them, or on the
// smaller ones of what they are aimed at (docs/decisions/0113).
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "luminaires/elements.h"
#include "sampling/sequence.h"
#include "surfaces/geometry.h"

namespace nocturne {

class DistantStart {
 public:
  DistantStart() = default;
  /// `bounds` holds the scene. Balls are put around the important shapes, one around all of many.
  DistantStart(const Elements& important, Geometry::Ball bounds);

  struct Start {
    Vec3 origin;
    /// Of the place across the direction, 1/m2.
    float pdf;
  };
  /// Of a photon that comes from `towards` (unit, away from the scene). The part `aimed`, in
  /// [0, 1), flies towards a ball, where there are any.
  Start sample(Vec3 towards, float aimed, const Uniform4& u) const;

  const Geometry::Ball& bounds() const { return bounds_; }

 private:
  struct Aim {
    Geometry::Ball ball;
    float part;
  };

  Geometry::Ball bounds_{};
  std::vector<Aim> aims_;  // parts add up to one
};

}  // namespace nocturne

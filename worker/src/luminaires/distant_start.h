// Where photons of distant light enter a scene: anywhere on a disc that faces them, or on the
// smaller ones of the shapes that they are aimed at (docs/decisions/0113).
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
  /// Balls are put around the important shapes, one around all of many. Photons that are not aimed
  /// reach `reached`, or all of the scene where it is empty.
  explicit DistantStart(const Elements& important, std::optional<Geometry::Ball> reached = {});

  struct Start {
    Vec3 origin;
    /// Of the place across the direction, 1/m2.
    float pdf;
  };
  /// Of a photon that comes from `towards` (unit, away from the scene). It starts outside of `lit`,
  /// which holds the scene. The part `aimed`, in [0, 1), flies towards a ball, where there are any.
  Start sample(Vec3 towards, const Geometry::Ball& lit, float aimed, const Uniform4& u) const;

 private:
  struct Aim {
    Geometry::Ball ball;
    float part;
  };

  std::vector<Aim> aims_;  // parts add up to one
  std::optional<Geometry::Ball> reached_;
};

}  // namespace nocturne

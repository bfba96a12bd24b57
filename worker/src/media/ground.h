// Altitude above a plane or a sphere, in double precision: right to a nanometre next to the ground
// of a planet, where the difference of two distances from its centre would know a millionth of a
// metre at best.
#pragma once

#include <cmath>
#include <limits>

#include "math/double3.h"

namespace nocturne {

/// A sphere of `radius` that touches the point `base`, where `up` is its normal; radius 0: the
/// plane there. Metres.
struct Ground {
  Double3 base, up;
  double radius = 0.0;

  double altitude(Double3 p) const {
    const Double3 q = p - base;
    return radius > 0.0 ? altitude_of(dot(q, q) + 2.0 * radius * dot(q, up)) : dot(q, up);
  }

  /// From the square of the distance to the centre less that of the radius.
  double altitude_of(double excess) const {
    return excess / (radius + std::sqrt(std::fmax(0.0, radius * radius + excess)));
  }
};

/// Altitude along a ray: a convex function of the distance, which falls up to `lowest` and then
/// rises.
class AltitudeAlong {
 public:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  AltitudeAlong(const Ground& ground, Double3 origin, Double3 direction) : ground_(ground) {
    const Double3 q = origin - ground.base;
    if (ground.radius > 0.0) {
      a_ = dot(direction, direction);
      b_ = dot(direction, q) + ground.radius * dot(direction, ground.up);
      c_ = dot(q, q) + 2.0 * ground.radius * dot(q, ground.up);
      lowest_ = std::fmax(0.0, -b_ / a_);
    } else {
      b_ = dot(direction, ground.up);
      c_ = dot(q, ground.up);
      lowest_ = b_ < 0.0 ? kNever : 0.0;
    }
  }

  double operator()(double t) const {
    return ground_.radius > 0.0 ? ground_.altitude_of((a_ * t + 2.0 * b_) * t + c_) : b_ * t + c_;
  }
  double lowest() const { return lowest_; }

  /// Where the altitude falls to h, or rises to it; kNever where it doesn't. May be negative.
  double falls_to(double h) const {
    if (!(b_ < 0.0)) return kNever;
    if (ground_.radius == 0.0) return (h - c_) / b_;
    const double excess = c_ - h * (h + 2.0 * ground_.radius);
    const double square = b_ * b_ - a_ * excess;
    return square >= 0.0 && h > -ground_.radius ? excess / (std::sqrt(square) - b_) : kNever;
  }
  double rises_to(double h) const {
    if (ground_.radius == 0.0) return b_ > 0.0 ? (h - c_) / b_ : kNever;
    const double excess = c_ - h * (h + 2.0 * ground_.radius);
    const double square = b_ * b_ - a_ * excess;
    if (!(square >= 0.0) || h < -ground_.radius) return kNever;
    const double root = std::sqrt(square);
    return b_ > 0.0 ? -excess / (b_ + root) : (root - b_) / a_;
  }

 private:
  Ground ground_;
  // Sphere: a t^2 + 2 b t + c is the excess of Ground::altitude_of. Plane: b t + c is the altitude.
  double a_ = 0.0, b_, c_, lowest_;
};

}  // namespace nocturne

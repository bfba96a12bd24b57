// Directions uniform over the solid angle of a triangle: Arvo, "Stratified sampling of spherical
// triangles", SIGGRAPH 1995. The solid angle is by van Oosterom and Strackee, "The solid angle of a
// plane triangle", IEEE Trans. Biomed. Eng. 30(2), 1983, which has no cancellation. In double
// precision.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/double3.h"
#include "math/functions.h"

namespace nocturne {

class SphericalTriangle {
 public:
  /// Unit vectors to the corners, from the point that looks at it.
  SphericalTriangle(Double3 a, Double3 b, Double3 c) : a_(a), b_(b), c_(c) {
    volume_ = std::fabs(dot(a, cross(b, c)));
    solid_angle_ = 2.0 * math::atan2(volume_, 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
  }

  /// sr, in [0, 2 pi].
  double solid_angle() const { return solid_angle_; }

  /// Two uniform numbers in [0, 1]; the solid angle must be positive.
  Double3 sample(double u1, double u2) const {
    // The angle alpha at a; c is the arc from a to b.
    const double along = dot(cross(a_, b_), cross(a_, c_));
    const double hypotenuse = std::sqrt(along * along + volume_ * volume_);
    const double cos_alpha = along / hypotenuse, sin_alpha = volume_ / hypotenuse;
    const double cos_c = dot(a_, b_);
    // Arvo's algorithm, with his letters.
    const double part = u1 * solid_angle_, sin_part = math::sin(part), cos_part = math::cos(part);
    const double s = sin_part * cos_alpha - cos_part * sin_alpha;
    const double t = cos_part * cos_alpha + sin_part * sin_alpha;
    const double u = t - cos_alpha, v = s + sin_alpha * cos_c;
    const double below = (v * s + u * t) * sin_alpha;
    const double q =
        below != 0.0 ? std::clamp(((v * t - u * s) * cos_alpha - v) / below, -1.0, 1.0) : 1.0;
    const Double3 c_hat = q * a_ + std::sqrt(1.0 - q * q) * across(c_, a_);
    const double z = 1.0 - u2 * (1.0 - dot(c_hat, b_));
    return z * b_ + std::sqrt(std::max(0.0, 1.0 - z * z)) * across(c_hat, b_);
  }

 private:
  // The unit part of v across the unit w; zero where there is none.
  static Double3 across(Double3 v, Double3 w) {
    const Double3 rest = v - dot(v, w) * w;
    const double length2 = dot(rest, rest);
    return length2 > 0.0 ? (1.0 / std::sqrt(length2)) * rest : Double3{0.0, 0.0, 0.0};
  }

  Double3 a_, b_, c_;
  double volume_, solid_angle_;
};

}  // namespace nocturne

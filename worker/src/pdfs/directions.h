// Densities over directions, per steradian, in a frame whose z axis is the normal.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/constants.h"
#include "math/functions.h"
#include "math/vec3.h"

namespace nocturne {

/// u1, u2 uniform in [0, 1).
inline Vec3 direction_from_z(float z, float u) {
  const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const float phi = kTwoPi * u;
  return {r * math::cos(phi), r * math::sin(phi), z};
}

/// Uniform over the upper hemisphere: the default of every opaque kernel, right before it is fast.
struct UniformHemisphere {
  static Vec3 sample(float u1, float u2) { return direction_from_z(u1, u2); }
  static float pdf(Vec3 w) { return w.z > 0.0f ? 0.5f * kInvPi : 0.0f; }
};

/// Uniform over all directions.
struct UniformSphere {
  static Vec3 sample(float u1, float u2) { return direction_from_z(1.0f - 2.0f * u1, u2); }
  static float pdf() { return 0.25f * kInvPi; }
};

/// In proportion to the cosine, by Shirley and Chiu's concentric map (J. Graphics Tools 2(3),
/// 1997).
struct CosineHemisphere {
  static Vec3 sample(float u1, float u2) {
    const float a = 2.0f * u1 - 1.0f, b = 2.0f * u2 - 1.0f;
    if (a == 0.0f && b == 0.0f) return {0.0f, 0.0f, 1.0f};
    const bool wide = std::fabs(a) > std::fabs(b);
    const float r = wide ? a : b;
    const float phi = wide ? 0.25f * kPi * (b / a) : 0.5f * kPi - 0.25f * kPi * (a / b);
    const float x = r * math::cos(phi), y = r * math::sin(phi);
    return {x, y, std::sqrt(std::max(0.0f, 1.0f - r * r))};
  }
  static float pdf(Vec3 w) { return std::max(0.0f, w.z) * kInvPi; }
};

}  // namespace nocturne

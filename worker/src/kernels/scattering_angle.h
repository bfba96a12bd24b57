// The angle by which a photon is turned, kept so that neither end loses digits: phase functions may
// peak within a fraction of a degree, where the cosine in single precision knows little.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/constants.h"
#include "math/frame.h"
#include "math/functions.h"
#include "math/vec3.h"

namespace nocturne {

struct ScatteringAngle {
  /// 1 - cos and 1 + cos; 0 straight on, and straight back.
  float less, more;

  /// `wo` is where the photon came from, `wi` where it goes; both point away from the vertex.
  static ScatteringAngle between(Vec3 wo, Vec3 wi) {
    const Vec3 onward = wi + wo, backward = wi - wo;
    return {0.5f * dot(onward, onward), 0.5f * dot(backward, backward)};
  }
  static ScatteringAngle from_less(float less) { return {less, 2.0f - less}; }
  static ScatteringAngle from_cosine(double cosine) {
    return {static_cast<float>(1.0 - cosine), static_cast<float>(1.0 + cosine)};
  }

  ScatteringAngle reversed() const { return {more, less}; }
  double cosine() const {
    return less < more ? 1.0 - static_cast<double>(less) : static_cast<double>(more) - 1.0;
  }
  /// Turned by this angle; v in [0, 1) chooses the azimuth.
  Vec3 direction(Vec3 wo, float v) const {
    const float r = std::sqrt(std::max(0.0f, less * more)), phi = kTwoPi * v;
    return normalized(Frame(-wo).to_world(
        {r * math::cos(phi), r * math::sin(phi), static_cast<float>(cosine())}));
  }
};

}  // namespace nocturne

// An orthonormal frame around a unit normal, so that kernels work with the normal along +z.
// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017: no branch, no singular
// direction.
#pragma once

#include <cmath>

#include "math/vec3.h"

namespace nocturne {

struct Frame {
  Vec3 tangent, bitangent, normal;

  explicit Frame(Vec3 n) : normal(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }

  Vec3 to_world(Vec3 v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
  Vec3 to_local(Vec3 v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }
};

}  // namespace nocturne

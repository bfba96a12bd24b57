// A unit vector in two numbers, to within a few units in the last place: the octahedron |x| + |y| +
// |z| = 1, unfolded to the square [-1, 1]^2. Cigolle et al., "A Survey of Efficient Representations
// for Independent Unit Vectors", JCGT 3(2), 2014, listings 1 and 2.
#pragma once

#include <cmath>

#include "math/double3.h"

namespace nocturne {

struct OctahedronPoint {
  float u, v;
};

inline OctahedronPoint unfold(Double3 n) {
  const double inverse = 1.0 / (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
  double u = n.x * inverse, v = n.y * inverse;
  if (n.z < 0.0) {
    const double folded = (1.0 - std::fabs(v)) * std::copysign(1.0, u);
    v = (1.0 - std::fabs(u)) * std::copysign(1.0, v);
    u = folded;
  }
  return {static_cast<float>(u), static_cast<float>(v)};
}

inline Double3 fold(float point_u, float point_v) {
  double u = point_u, v = point_v;
  const double z = 1.0 - std::fabs(u) - std::fabs(v);
  if (z < 0.0) {
    const double unfolded = (1.0 - std::fabs(v)) * std::copysign(1.0, u);
    v = (1.0 - std::fabs(u)) * std::copysign(1.0, v);
    u = unfolded;
  }
  const Double3 n{u, v, z};
  return n.normalized();
}

}  // namespace nocturne

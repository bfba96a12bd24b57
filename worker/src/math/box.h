// Boxes along the axes.
#pragma once

#include <algorithm>
#include <limits>

#include "math/vec3.h"

namespace nocturne {

inline Vec3 smaller(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3 larger(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// Without a corner one that nothing reaches.
struct Box {
  static constexpr float kInfinite = std::numeric_limits<float>::infinity();

  Vec3 low{kInfinite, kInfinite, kInfinite}, high{-kInfinite, -kInfinite, -kInfinite};

  void add(Vec3 p) {
    low = smaller(low, p);
    high = larger(high, p);
  }
  void add(const Box& box) {
    low = smaller(low, box.low);
    high = larger(high, box.high);
  }
  Vec3 middle() const { return 0.5f * (low + high); }
};

/// Around them all.
template <class Boxes>
Box around(const Boxes& boxes) {
  Box all;
  for (const Box& box : boxes) all.add(box);
  return all;
}

/// Whether they are no further apart along any axis than `reach`, m.
inline bool reaches(const Box& a, const Box& b, double reach) {
  return std::max({b.low.x - a.high.x, a.low.x - b.high.x, b.low.y - a.high.y, a.low.y - b.high.y,
                   b.low.z - a.high.z, a.low.z - b.high.z}) <= reach;
}

}  // namespace nocturne

// Intensity over directions as in a photometric file (IES LM-63, type C), linear between given
// angles.
#pragma once

#include <vector>

#include "math/vec3.h"

namespace nocturne {

class IntensityProfile {
 public:
  struct Table {
    /// Direction of vertical angle 0, and of horizontal angle 0; orthonormal. Horizontal angles
    /// turn right-handed about the axis.
    Vec3 axis, zero;
    /// Radians, increasing, within [0, pi] and [0, 2 pi]; at least two and one. One horizontal
    /// angle: the same all around. Directions outside are dark.
    std::vector<float> vertical, horizontal;
    /// By horizontal angle, then vertical; finite, not negative.
    std::vector<float> values;
  };

  /// Throws std::invalid_argument where the table is not as described.
  explicit IntensityProfile(Table table);

  /// Unit direction, away from the lamp.
  float operator()(Vec3 direction) const;

  /// The integral over all directions, sr times the unit of the values.
  double flux() const;

 private:
  Table table_;
  Vec3 side_;  // horizontal angle pi / 2
};

}  // namespace nocturne

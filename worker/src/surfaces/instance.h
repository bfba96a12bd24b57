// A group of shapes shown once more, elsewhere. Rays are carried into the group in double
// precision: a matrix that is inverted in single precision would move them by many units in the
// last place, most of all where the scales differ.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "math/double3.h"
#include "math/functions.h"

namespace nocturne {

/// Rows of the 3 x 4 matrix from group to scene.
using Transform = std::array<double, 12>;

struct Instance {
  /// At least 1.
  std::uint32_t group;
  /// One for each time step (time_steps.h), at least one; each can be inverted.
  std::vector<Transform> transforms;
};

/// Where a group stands at one time.
struct Placement {
  Matrix3 linear, inverse;
  Double3 translation;

  explicit Placement(const Transform& t)
      : linear{{t[0], t[1], t[2]}, {t[4], t[5], t[6]}, {t[8], t[9], t[10]}},
        inverse(linear.inverse()),
        translation(t[3], t[7], t[11]) {}

  Double3 point_to_scene(Double3 p) const { return linear * p + translation; }
  Double3 point_to_group(Double3 p) const { return inverse * (p - translation); }
  /// By the inverse transposed, which keeps out out even in a mirror; not of unit length. One over
  /// its length is how far the group is stretched along the normal.
  Double3 normal_to_scene(Double3 n) const { return transposed_times(inverse, n); }

  /// At most this times as long as in the group is anything in the scene.
  double largest_stretch() const {
    // The root of the sum of squares is never less than the largest singular value.
    const double bound =
        std::sqrt(dot(linear.x, linear.x) + dot(linear.y, linear.y) + dot(linear.z, linear.z));
    const double uniform = math::cbrt(std::fabs(linear.determinant()));
    const bool rigid = std::fabs(bound * bound - 3.0 * uniform * uniform) < 1e-6 * bound * bound;
    return rigid ? uniform : bound;
  }

  /// False where a motion squeezes the group flat, so that it can't be seen.
  bool valid() const {
    return std::isfinite(dot(inverse.x, inverse.x) + dot(inverse.y, inverse.y) +
                         dot(inverse.z, inverse.z) + dot(translation, translation));
  }
};

/// An instance as it is traced.
class PlacedInstance {
 public:
  /// Throws std::invalid_argument where a matrix can't be inverted, or there are no or too many
  /// time steps.
  explicit PlacedInstance(Instance instance);

  std::uint32_t group() const { return instance_.group; }
  std::size_t time_steps() const { return instance_.transforms.size(); }
  Placement placement_at_step(std::size_t step) const {
    return Placement(instance_.transforms[step]);
  }
  Placement placement(float time) const {
    return instance_.transforms.size() == 1 ? first_ : moving(time);
  }

 private:
  Placement moving(float time) const;

  Instance instance_;
  Placement first_;
};

}  // namespace nocturne

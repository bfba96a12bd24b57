// Where a sensor stands and looks, at rest or over the shutter.
#pragma once

#include <cstddef>
#include <vector>

#include "math/vec3.h"

namespace nocturne {

struct Pose {
  Vec3 position;
  /// Orthonormal, right x up = -forward.
  Vec3 right, up, forward;
};

/// Poses at equally spaced times over the shutter [0, 1], linear in between: the position exactly
/// so; the frame made orthonormal again wherever it turns, forward first, then right.
class Motion {
 public:
  /// Throws std::invalid_argument unless there is a pose, each orthonormal within 1e-3, and none is
  /// half a turn (within 2 degrees) away from the one before: then nothing says which way round.
  explicit Motion(std::vector<Pose> poses);

  bool moves() const { return poses_.size() > 1; }

  const Pose& start() const { return poses_.front(); }
  std::size_t steps() const { return poses_.size(); }

  /// time in [0, 1].
  Pose at(float time) const { return moves() ? between(time) : start(); }

 private:
  Pose between(float time) const;

  std::vector<Pose> poses_;
};

}  // namespace nocturne

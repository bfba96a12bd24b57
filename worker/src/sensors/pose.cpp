#include "sensors/pose.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "math/time_steps.h"

namespace nocturne {
namespace {

bool is_orthonormal(const Pose& pose) {
  const auto close = [](float value, float wanted) { return std::fabs(value - wanted) < 1e-3f; };
  return close(dot(pose.forward, pose.forward), 1.0f) && close(dot(pose.right, pose.right), 1.0f) &&
         close(dot(pose.forward, pose.right), 0.0f) &&
         close(dot(cross(pose.right, pose.forward), pose.up), 1.0f) &&
         close(dot(pose.up, pose.up), 1.0f);
}

// 1 + 2 cos of the angle of the turn from one frame to the other (the trace of its matrix).
float trace_of_turn(const Pose& from, const Pose& to) {
  return dot(from.right, to.right) + dot(from.up, to.up) + dot(from.forward, to.forward);
}

bool same(Vec3 a, Vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

Vec3 mix(Vec3 a, Vec3 b, float t) { return a + t * (b - a); }

}  // namespace

Motion::Motion(std::vector<Pose> poses) : poses_(std::move(poses)) {
  if (poses_.empty()) throw std::invalid_argument("a sensor without a pose");
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (!is_orthonormal(poses_[i])) {
      throw std::invalid_argument("a sensor's frame is not orthonormal");
    }
    if (i > 0 && trace_of_turn(poses_[i - 1], poses_[i]) < -0.998f) {
      throw std::invalid_argument("a sensor makes half a turn from one pose to the next");
    }
  }
}

Pose Motion::between(float time) const {
  const auto [step, t] = segment_at(time, poses_.size());
  const Pose& from = poses_[step];
  const Pose& to = poses_[step + 1];
  Pose pose{mix(from.position, to.position, t), from.right, from.up, from.forward};
  // A translation keeps its frame to the last bit.
  if (same(from.right, to.right) && same(from.forward, to.forward)) return pose;
  pose.forward = normalized(mix(from.forward, to.forward, t));
  const Vec3 right = mix(from.right, to.right, t);
  pose.right = normalized(right - dot(right, pose.forward) * pose.forward);
  pose.up = cross(pose.right, pose.forward);
  return pose;
}

}  // namespace nocturne

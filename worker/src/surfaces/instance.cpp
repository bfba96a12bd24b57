#include "surfaces/instance.h"

#include <stdexcept>
#include <utility>

#include "math/time_steps.h"

namespace nocturne {
namespace {

const Transform& first_of(const Instance& instance) {
  if (instance.transforms.empty() || instance.transforms.size() > kMaxTimeSteps) {
    throw std::invalid_argument("an instance needs 1 to 129 time steps");
  }
  return instance.transforms.front();
}

}  // namespace

PlacedInstance::PlacedInstance(Instance instance)
    : instance_(std::move(instance)), first_(first_of(instance_)) {
  for (const Transform& transform : instance_.transforms) {
    if (!Placement(transform).valid()) {
      throw std::invalid_argument("an instance has a matrix that can't be inverted");
    }
  }
}

Placement PlacedInstance::moving(float time) const {
  const TimeSegment segment = segment_at(time, time_steps());
  const Transform& from = instance_.transforms[segment.first];
  const Transform& to = instance_.transforms[segment.first + 1];
  Transform between;
  for (std::size_t i = 0; i < between.size(); ++i) {
    between[i] = from[i] + static_cast<double>(segment.fraction) * (to[i] - from[i]);
  }
  return Placement(between);
}

}  // namespace nocturne

// The rays that the tracer searches for, exactly and in its order.
#pragma once

#include <vector>

#include "math/ray.h"

namespace nocturne::bench {

struct RecordedRays {
  struct Segment {
    Ray ray;
    float end;
  };
  /// For the nearest hit; and for whether there is any.
  std::vector<Segment> nearest, any;
};

/// Records the rays of searches for many, from its construction to its destruction; one at a time,
/// one thread only.
class RayRecorder {
 public:
  explicit RayRecorder(RecordedRays& into);
  ~RayRecorder();
  RayRecorder(const RayRecorder&) = delete;
  RayRecorder& operator=(const RayRecorder&) = delete;
};

}  // namespace nocturne::bench

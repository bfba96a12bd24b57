// The rays that the tracer asks Embree for, exactly and in its order.
#pragma once

#include <embree3/rtcore.h>

#include <vector>

#include "math/ray.h"

namespace nocturne::bench {

struct RecordedRays {
  std::vector<Ray> rays;
  /// The tracer's own tree, so that whoever replays the rays searches the same one.
  RTCScene tree = nullptr;
};

/// Keeps every ray of rtcIntersect1 while it lives; one at a time, one thread only.
class RayRecorder {
 public:
  explicit RayRecorder(RecordedRays& into);
  ~RayRecorder();
  RayRecorder(const RayRecorder&) = delete;
  RayRecorder& operator=(const RayRecorder&) = delete;
};

/// Embree's rtcIntersect1, past the recorder.
void intersect_directly(RTCScene tree, RTCIntersectContext* context, RTCRayHit* query);

}  // namespace nocturne::bench

// The rays that the tracer asks Embree for, exactly and in its order.
#pragma once

#include <embree3/rtcore.h>

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
  /// The tracer's own tree, so that whoever replays the rays searches the same one.
  RTCScene tree = nullptr;
};

/// Keeps every ray of rtcIntersect8 and rtcOccluded8 while it lives; one at a time, one thread
/// only.
class RayRecorder {
 public:
  explicit RayRecorder(RecordedRays& into);
  ~RayRecorder();
  RayRecorder(const RayRecorder&) = delete;
  RayRecorder& operator=(const RayRecorder&) = delete;
};

/// Embree's own, past the recorder.
void intersect_directly(const int* valid, RTCScene tree, RTCIntersectContext* context,
                        RTCRayHit8* query);
void occluded_directly(const int* valid, RTCScene tree, RTCIntersectContext* context,
                       RTCRay8* query);

}  // namespace nocturne::bench

#include "ray_recorder.h"

namespace {

nocturne::bench::RecordedRays* recording = nullptr;

}  // namespace

// The linker sends calls of rtcIntersect1 to __wrap_rtcIntersect1, and __real_rtcIntersect1 is
// Embree's own (--wrap). While nothing is recorded it costs the tracer a test and a jump.
extern "C" {
void __real_rtcIntersect1(RTCScene tree, RTCIntersectContext* context, RTCRayHit* query);

void __wrap_rtcIntersect1(RTCScene tree, RTCIntersectContext* context, RTCRayHit* query) {
  if (recording != nullptr) [[unlikely]] {
    const RTCRay& ray = query->ray;
    recording->rays.push_back(
        {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}});
    recording->tree = tree;
  }
  __real_rtcIntersect1(tree, context, query);
}
}

namespace nocturne::bench {

RayRecorder::RayRecorder(RecordedRays& into) { recording = &into; }
RayRecorder::~RayRecorder() { recording = nullptr; }

void intersect_directly(RTCScene tree, RTCIntersectContext* context, RTCRayHit* query) {
  __real_rtcIntersect1(tree, context, query);
}

}  // namespace nocturne::bench

#include "ray_recorder.h"

namespace {

using nocturne::bench::RecordedRays;

RecordedRays* recording = nullptr;

void record(const int* valid, const RTCRay8& ray, std::vector<RecordedRays::Segment>& into) {
  for (int i = 0; i < 8; ++i) {
    if (valid[i] == 0) continue;
    into.push_back(
        {{{ray.org_x[i], ray.org_y[i], ray.org_z[i]}, {ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]}},
         ray.tfar[i]});
  }
}

}  // namespace

// The linker sends calls of rtcIntersect8 to __wrap_rtcIntersect8, and __real_rtcIntersect8 is
// Embree's own (--wrap); so for rtcOccluded8. While nothing is recorded it costs the tracer a test
// and a jump for a packet.
extern "C" {
void __real_rtcIntersect8(const int* valid, RTCScene tree, RTCIntersectContext* context,
                          RTCRayHit8* query);
void __real_rtcOccluded8(const int* valid, RTCScene tree, RTCIntersectContext* context,
                         RTCRay8* query);

void __wrap_rtcIntersect8(const int* valid, RTCScene tree, RTCIntersectContext* context,
                          RTCRayHit8* query) {
  if (recording != nullptr) [[unlikely]] {
    record(valid, query->ray, recording->nearest);
    recording->tree = tree;
  }
  __real_rtcIntersect8(valid, tree, context, query);
}

void __wrap_rtcOccluded8(const int* valid, RTCScene tree, RTCIntersectContext* context,
                         RTCRay8* query) {
  if (recording != nullptr) [[unlikely]]
    record(valid, *query, recording->any);
  __real_rtcOccluded8(valid, tree, context, query);
}
}

namespace nocturne::bench {

RayRecorder::RayRecorder(RecordedRays& into) { recording = &into; }
RayRecorder::~RayRecorder() { recording = nullptr; }

void intersect_directly(const int* valid, RTCScene tree, RTCIntersectContext* context,
                        RTCRayHit8* query) {
  __real_rtcIntersect8(valid, tree, context, query);
}
void occluded_directly(const int* valid, RTCScene tree, RTCIntersectContext* context,
                       RTCRay8* query) {
  __real_rtcOccluded8(valid, tree, context, query);
}

}  // namespace nocturne::bench

#include "ray_recorder.h"

#include <cstdint>
#include <optional>
#include <span>

#include "surfaces/geometry.h"

namespace {

using nocturne::Geometry;
using nocturne::Hit;
using nocturne::RayCoherence;
using nocturne::TimedRay;
using nocturne::bench::RecordedRays;

RecordedRays* recording = nullptr;

void record(std::span<const TimedRay> rays, std::vector<RecordedRays::Segment>& into) {
  for (const TimedRay& ray : rays) into.push_back({ray.ray, ray.end});
}

}  // namespace

// The linker sends calls of Geometry::intersect for many rays to the symbol that begins with
// __wrap, and the one that begins with __real is the geometry's own (--wrap, CMakeLists.txt); so
// for Geometry::occluded. While nothing is recorded it costs the tracer a test and a jump for a
// batch.
void own_intersect(const Geometry*, std::span<const TimedRay>,
                   std::span<std::optional<Hit>>) asm("__real_" INTERSECT_SYMBOL);
void intersect(const Geometry*, std::span<const TimedRay>,
               std::span<std::optional<Hit>>) asm("__wrap_" INTERSECT_SYMBOL);
void own_occluded(const Geometry*, std::span<const TimedRay>, std::span<std::uint8_t>,
                  RayCoherence) asm("__real_" OCCLUDED_SYMBOL);
void occluded(const Geometry*, std::span<const TimedRay>, std::span<std::uint8_t>,
              RayCoherence) asm("__wrap_" OCCLUDED_SYMBOL);

void intersect(const Geometry* geometry, std::span<const TimedRay> rays,
               std::span<std::optional<Hit>> hits) {
  if (recording != nullptr) [[unlikely]]
    record(rays, recording->nearest);
  own_intersect(geometry, rays, hits);
}

void occluded(const Geometry* geometry, std::span<const TimedRay> rays,
              std::span<std::uint8_t> blocked, RayCoherence coherence) {
  if (recording != nullptr) [[unlikely]]
    record(rays, recording->any);
  own_occluded(geometry, rays, blocked, coherence);
}

namespace nocturne::bench {

RayRecorder::RayRecorder(RecordedRays& into) { recording = &into; }
RayRecorder::~RayRecorder() { recording = nullptr; }

}  // namespace nocturne::bench

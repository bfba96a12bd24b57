// What Embree calls for shapes that it does not know: spheres, and instances (carried in double
// precision, which Embree's own do not).
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "surfaces/instance.h"
#include "surfaces/shapes.h"

namespace nocturne {

/// Every search with a filter: what Embree hands back a pointer to, and where its ray starts before
/// that is rounded.
struct ExactContext {
  RTCIntersectContext context;
  Double3 origin;
};

/// Spheres with the same number of time steps: one Embree geometry, a primitive each.
struct EmbreeSpheres {
  struct One {
    const Sphere* sphere;
    /// What a hit reports as its geometry.
    unsigned id;
  };
  std::vector<One> all;
};

/// Instances with the same number of time steps: one Embree geometry, a primitive each.
struct EmbreeInstances {
  struct One {
    const PlacedInstance* instance;
    /// Of the group; committed.
    RTCScene scene;
    /// What a hit reports.
    std::uint32_t index;
  };
  std::vector<One> all;
};

/// A geometry, not yet committed, that refers to its argument for as long as it lives.
RTCGeometry new_geometry(RTCDevice device, const EmbreeSpheres& spheres);
RTCGeometry new_geometry(RTCDevice device, const EmbreeInstances& instances);

}  // namespace nocturne

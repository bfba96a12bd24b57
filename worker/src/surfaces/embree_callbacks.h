// What Embree calls for shapes that it does not know: spheres, and instances (carried in double
// precision, which Embree's own do not).
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "surfaces/instance.h"
#include "surfaces/shapes.h"

namespace nocturne {

/// A sphere under the identifier that it has in its Embree scene.
struct EmbreeSphere {
  const Sphere* sphere;
  unsigned geometry_id;
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
RTCGeometry new_geometry(RTCDevice device, const EmbreeSphere& sphere);
RTCGeometry new_geometry(RTCDevice device, const EmbreeInstances& instances);

}  // namespace nocturne

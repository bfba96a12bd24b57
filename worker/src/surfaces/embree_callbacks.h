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

/// Of a sphere or an instance at a time step, rounded outwards.
RTCBounds bounds_of(const Sphere& sphere, std::size_t step);
RTCBounds bounds_of(const EmbreeInstances::One& one, std::size_t step);

/// What a ray meets first in an instance, up to a distance; its geomID is invalid where that is
/// nothing.
RTCRayHit nearest_in(const EmbreeInstances::One& one, RTCRay ray);
/// Whether it meets anything.
bool blocked_by(const EmbreeInstances::One& one, RTCRay ray);

/// A geometry, not yet committed, that refers to its argument for as long as it lives.
RTCGeometry new_geometry(RTCDevice device, const EmbreeSpheres& spheres);
RTCGeometry new_geometry(RTCDevice device, const EmbreeInstances& instances);

}  // namespace nocturne

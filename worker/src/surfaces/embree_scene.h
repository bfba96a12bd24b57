// The scene's shapes as Embree searches for them.
#pragma once

#include <embree3/rtcore.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <list>
#include <map>
#include <stop_token>
#include <variant>
#include <vector>

#include "math/ray.h"
#include "surfaces/embree_callbacks.h"
#include "surfaces/exact_crossing.h"
#include "surfaces/hit.h"
#include "surfaces/instance.h"
#include "surfaces/locate.h"
#include "surfaces/shapes.h"

namespace nocturne {

/// Opens Embree with the same settings for all workers; std::runtime_error where it can't start.
RTCDevice new_device();
/// How.
extern const char* const kDeviceConfiguration;

/// Shapes of group 0 are geometries of the top scene under their own number; behind them, the
/// instances. A group is a separate scene, numbered from 0.
struct EmbreeScene {
  struct Group {
    RTCScene scene = nullptr;
    std::vector<std::uint32_t> surfaces;  // by Embree's number in the group
  };

  /// See Geometry.
  EmbreeScene(std::vector<Shape> s, const std::vector<std::uint32_t>& group_of_shape,
              std::vector<Instance> all, const std::stop_token& stop);
  ~EmbreeScene() { release(); }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// From Embree's numbers. Inline: 4 % of the Cornell box.
  [[gnu::always_inline]] Hit located(Double3 origin, Vec3 direction, float time,
                                     Found found) const {
    if (found.instance != Hit::kNoInstance) {
      found.surface = (*instance_surfaces[found.instance])[found.surface];
      return locate(shapes[found.surface], instances[found.instance].placement(time), origin,
                    direction, found, time);
    }
    const auto of = [&](const auto& shape) {
      return locate(shape, origin, direction, found, time);
    };
    return std::visit(of, shapes[found.surface]);
  }

  /// f(shape, placement or null) of what a hit is on.
  template <class F>
  auto with_placement(std::uint32_t surface, std::uint32_t instance, float time, const F& f) const {
    if (instance == Hit::kNoInstance) return f(shapes[surface], nullptr);
    const Placement placement = instances[instance].placement(time);
    return f(shapes[surface], &placement);
  }

  // Embree keeps pointers into all of these.
  std::vector<Shape> shapes;
  std::vector<PlacedInstance> instances;
  std::list<EmbreeSpheres> sphere_sets;
  std::list<EmbreeInstances> instance_sets;
  std::map<std::uint32_t, Group> groups;
  std::vector<const std::vector<std::uint32_t>*> instance_surfaces;  // by instance
  std::vector<CloseSurface> close;                                   // by surface
  float largest_reach = 0.0f;
  /// Of all shapes in no group and all instances.
  RTCScene scene = nullptr;

 private:
  void build(const std::vector<std::uint32_t>& group_of_shape, const std::stop_token& stop);
  RTCScene new_scene() const;
  void commit(RTCScene filled, std::stop_token stop) const;
  void attach_instances();
  void release();

  RTCDevice device_ = nullptr;
};

/// A ray does not meet the plane that it starts in: a camera on a wall sees the room.
constexpr float kBeyondStart = std::numeric_limits<float>::min();

/// A single ray, as Embree takes it.
inline RTCRay embree_ray(const Ray& ray, float time, float end) {
  RTCRay r;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tnear = kBeyondStart;
  r.tfar = end;
  r.time = time;
  r.mask = ~0u;
  r.id = 0;
  r.flags = 0;
  return r;
}
/// Embree ends the program where it is given other rays: numbers that are none, or of no scene.
/// Such a ray meets nothing.
constexpr float kMostSearched = 1e18f;
inline bool can_be_searched(const RTCRay& ray) {
  const auto usable = [](float each) { return std::fabs(each) < kMostSearched; };
  return usable(ray.org_x) && usable(ray.org_y) && usable(ray.org_z) && usable(ray.dir_x) &&
         usable(ray.dir_y) && usable(ray.dir_z) && ray.tfar == ray.tfar && usable(ray.time);
}
inline RTCRayHit embree_query(const Ray& ray, float time) {
  RTCRayHit query;
  query.ray = embree_ray(ray, time, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

/// What Embree found for it.
inline Found found_by(const RTCRayHit& query) {
  return {query.hit.geomID, query.hit.instID[0], query.hit.primID,
          query.hit.u,      query.hit.v,         query.ray.tfar};
}

}  // namespace nocturne

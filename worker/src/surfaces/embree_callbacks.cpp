#include "surfaces/embree_callbacks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "surfaces/embree_scene.h"
#include "surfaces/sphere_intersection.h"

namespace nocturne {
namespace {

// Rounded outwards by `margin` and by two units in the last place, which cover the conversion to
// float.
RTCBounds outward(Double3 lower, Double3 upper, double margin) {
  const auto below = [margin](double v) {
    return static_cast<float>(v - margin -
                              2.0 * std::numeric_limits<float>::epsilon() * std::fabs(v));
  };
  const auto above = [margin](double v) {
    return static_cast<float>(v + margin +
                              2.0 * std::numeric_limits<float>::epsilon() * std::fabs(v));
  };
  RTCBounds box{};
  box.lower_x = below(lower.x);
  box.lower_y = below(lower.y);
  box.lower_z = below(lower.z);
  box.upper_x = above(upper.x);
  box.upper_y = above(upper.y);
  box.upper_z = above(upper.z);
  return box;
}

const EmbreeSpheres::One& sphere_of(void* data, unsigned primitive) {
  return static_cast<const EmbreeSpheres*>(data)->all[primitive];
}

// Rounded outwards.
RTCBounds bounds_of(const Sphere& sphere, std::size_t step) {
  const Double3 centre = centre_at_step(sphere, step);
  const Double3 half{sphere.radius, sphere.radius, sphere.radius};
  return outward(centre - half, centre + half, 0.0);
}

void sphere_bounds(const RTCBoundsFunctionArguments* arguments) {
  const Sphere& sphere = *sphere_of(arguments->geometryUserPtr, arguments->primID).sphere;
  *arguments->bounds_o = bounds_of(sphere, arguments->timeStep);
}

// A ray of a packet of n, as single rays are.
RTCRay ray_at(RTCRayN* rays, unsigned n, unsigned i) { return rtcGetRayFromRayN(rays, n, i); }

Double3 origin_of(const RTCRay& ray) { return {ray.org_x, ray.org_y, ray.org_z}; }

// Null in a search without a filter.
ExactContext* exact_context(RTCIntersectContext* context) {
  return context->filter == nullptr ? nullptr : reinterpret_cast<ExactContext*>(context);
}

// take(t) for the crossings within (near, far) of the ray, in order, until it takes one.
template <class Take>
void take_crossing(const Sphere& sphere, Double3 origin, const RTCRay& ray, const Take& take) {
  const auto crossings = cross_sphere(centre_at(sphere, ray.time), sphere.radius, origin,
                                      {ray.dir_x, ray.dir_y, ray.dir_z});
  if (!crossings) return;
  for (const double t : {crossings->near, crossings->far}) {
    if (t > ray.tnear && t < ray.tfar && take(static_cast<float>(t))) return;
  }
}

RTCHit hit_of(const EmbreeSpheres::One& sphere, const RTCIntersectContext& context) {
  RTCHit hit{};
  hit.geomID = sphere.id;
  hit.instID[0] = context.instID[0];
  return hit;
}

// To the search's filter: whether it takes the hit.
bool offer(const RTCIntersectFunctionNArguments* arguments, RTCRay ray, RTCHit hit) {
  int valid = -1;
  RTCFilterFunctionNArguments offered{&valid,
                                      arguments->geometryUserPtr,
                                      arguments->context,
                                      reinterpret_cast<RTCRayN*>(&ray),
                                      reinterpret_cast<RTCHitN*>(&hit),
                                      1};
  arguments->context->filter(&offered);
  return valid != 0;
}

void sphere_intersect(const RTCIntersectFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  const EmbreeSpheres::One& sphere = sphere_of(arguments->geometryUserPtr, arguments->primID);
  RTCRayN* rays = RTCRayHitN_RayN(arguments->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(arguments->rayhit, n);
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const RTCRay ray = ray_at(rays, n, i);
    const RTCHit hit = hit_of(sphere, *arguments->context);
    const ExactContext* exact = exact_context(arguments->context);
    const Double3 origin = exact != nullptr ? exact->origin : origin_of(ray);
    take_crossing(*sphere.sphere, origin, ray, [&](float t) {
      RTCRay until = ray;
      until.tfar = t;
      if (exact != nullptr && !offer(arguments, until, hit)) return false;
      RTCRayN_tfar(rays, n, i) = t;
      rtcCopyHitToHitN(hits, &hit, n, i);
      return true;
    });
  }
}

// Embree's sign of an occluded ray.
constexpr float kOccluded = -std::numeric_limits<float>::infinity();

void sphere_occluded(const RTCOccludedFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  const EmbreeSpheres::One& sphere = sphere_of(arguments->geometryUserPtr, arguments->primID);
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const RTCRay ray = ray_at(arguments->ray, n, i);
    take_crossing(*sphere.sphere, origin_of(ray), ray, [&](float) {
      RTCRayN_tfar(arguments->ray, n, i) = kOccluded;
      return true;
    });
  }
}

// The corners of the group's box, each moved linearly between two time steps, stay in the box that
// moves linearly between theirs. Carrying a ray into the group moves it by a unit in the last place
// of its coordinates: as much is added all round.
RTCBounds bounds_of(const EmbreeInstances::One& one, std::size_t step) {
  RTCBounds group;
  rtcGetSceneBounds(one.scene, &group);
  const Placement placement = one.instance->placement_at_step(step);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  Double3 lower{kInfinite, kInfinite, kInfinite}, upper{-kInfinite, -kInfinite, -kInfinite};
  for (int corner = 0; corner < 8; ++corner) {
    const Double3 p = placement.point_to_scene({corner & 1 ? group.upper_x : group.lower_x,
                                                corner & 2 ? group.upper_y : group.lower_y,
                                                corner & 4 ? group.upper_z : group.lower_z});
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  const double largest = std::max(max_abs(lower), max_abs(upper));
  return outward(lower, upper, 4.0 * std::numeric_limits<float>::epsilon() * largest);
}

void instance_bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto* instances = static_cast<const EmbreeInstances*>(arguments->geometryUserPtr);
  *arguments->bounds_o = bounds_of(instances->all[arguments->primID], arguments->timeStep);
}

// The ray as the group sees it; empty where the group can't be seen. Distances along the ray do not
// change, as the direction is carried along unnormalised.
std::optional<RTCRay> ray_in_group(const PlacedInstance& instance, RTCRay ray,
                                   ExactContext* exact) {
  const Placement placement = instance.placement(ray.time);
  if (!placement.valid()) return std::nullopt;
  const Double3 start = placement.point_to_group(exact != nullptr ? exact->origin : origin_of(ray));
  if (exact != nullptr) exact->origin = start;
  const Vec3 origin = start.rounded();
  const Vec3 direction =
      (placement.inverse * Double3(Vec3{ray.dir_x, ray.dir_y, ray.dir_z})).rounded();
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  if (!can_be_searched(ray)) return std::nullopt;
  return ray;
}

const EmbreeInstances::One& instance_of(void* data, unsigned primitive) {
  return static_cast<const EmbreeInstances*>(data)->all[primitive];
}

void instance_intersect(const RTCIntersectFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  const EmbreeInstances::One& one = instance_of(arguments->geometryUserPtr, arguments->primID);
  RTCRayN* rays = RTCRayHitN_RayN(arguments->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(arguments->rayhit, n);
  arguments->context->instID[0] = one.index;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    ExactContext* const exact = exact_context(arguments->context);
    const Double3 outside = exact != nullptr ? exact->origin : Double3();
    const auto ray = ray_in_group(*one.instance, ray_at(rays, n, i), exact);
    if (!ray) continue;
    RTCRayHit in_group{*ray, {}};
    in_group.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(one.scene, arguments->context, &in_group);
    if (exact != nullptr) exact->origin = outside;
    if (in_group.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    RTCRayN_tfar(rays, n, i) = in_group.ray.tfar;
    rtcCopyHitToHitN(hits, &in_group.hit, n, i);
  }
  arguments->context->instID[0] = RTC_INVALID_GEOMETRY_ID;
}

void instance_occluded(const RTCOccludedFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  const EmbreeInstances::One& one = instance_of(arguments->geometryUserPtr, arguments->primID);
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    auto ray = ray_in_group(*one.instance, ray_at(arguments->ray, n, i), nullptr);
    if (!ray) continue;
    rtcOccluded1(one.scene, arguments->context, &*ray);
    if (ray->tfar < 0.0f) RTCRayN_tfar(arguments->ray, n, i) = kOccluded;
  }
}

template <class Data>
RTCGeometry user_geometry(RTCDevice device, const Data& data, std::size_t primitives,
                          std::size_t time_steps, RTCBoundsFunction bounds,
                          RTCIntersectFunctionN intersect, RTCOccludedFunctionN occluded) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(primitives));
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(time_steps));
  // Embree only hands the pointer back, and the callbacks above read.
  rtcSetGeometryUserData(geometry, const_cast<Data*>(&data));
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occluded);
  return geometry;
}

}  // namespace

RTCGeometry new_geometry(RTCDevice device, const EmbreeSpheres& spheres) {
  return user_geometry(device, spheres, spheres.all.size(),
                       spheres.all.front().sphere->later_centres.size() + 1, sphere_bounds,
                       sphere_intersect, sphere_occluded);
}

RTCGeometry new_geometry(RTCDevice device, const EmbreeInstances& instances) {
  return user_geometry(device, instances, instances.all.size(),
                       instances.all.front().instance->time_steps(), instance_bounds,
                       instance_intersect, instance_occluded);
}

}  // namespace nocturne

#include "surfaces/embree_callbacks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

void sphere_bounds(const RTCBoundsFunctionArguments* arguments) {
  const Sphere& s = *static_cast<const EmbreeSphere*>(arguments->geometryUserPtr)->sphere;
  const Double3 centre = centre_at_step(s, arguments->timeStep);
  const Double3 half{s.radius, s.radius, s.radius};
  *arguments->bounds_o = outward(centre - half, centre + half, 0.0);
}

// The first crossing within (near, far) of the ray.
std::optional<float> first_crossing(const Sphere& sphere, const RTCRayN* const_ray, unsigned n,
                                    unsigned i) {
  auto* ray = const_cast<RTCRayN*>(const_ray);  // Embree's accessors give references
  const auto crossings =
      cross_sphere(centre_at(sphere, RTCRayN_time(ray, n, i)), sphere.radius,
                   {RTCRayN_org_x(ray, n, i), RTCRayN_org_y(ray, n, i), RTCRayN_org_z(ray, n, i)},
                   {RTCRayN_dir_x(ray, n, i), RTCRayN_dir_y(ray, n, i), RTCRayN_dir_z(ray, n, i)});
  if (!crossings) return std::nullopt;
  for (const double t : {crossings->near, crossings->far}) {
    if (t > RTCRayN_tnear(ray, n, i) && t < RTCRayN_tfar(ray, n, i)) return static_cast<float>(t);
  }
  return std::nullopt;
}

// To the search's filter, which keeps no hit.
void offer(const RTCIntersectFunctionNArguments* arguments, float distance) {
  const auto& geometry = *static_cast<const EmbreeSphere*>(arguments->geometryUserPtr);
  RTCHit hit{};
  hit.geomID = geometry.geometry_id;
  hit.instID[0] = arguments->context->instID[0];
  RTCRay ray = reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray;
  ray.tfar = distance;
  int valid = -1;
  RTCFilterFunctionNArguments offered{&valid,
                                      arguments->geometryUserPtr,
                                      arguments->context,
                                      reinterpret_cast<RTCRayN*>(&ray),
                                      reinterpret_cast<RTCHitN*>(&hit),
                                      1};
  arguments->context->filter(&offered);
}

void sphere_intersect(const RTCIntersectFunctionNArguments* arguments) {
  const auto& geometry = *static_cast<const EmbreeSphere*>(arguments->geometryUserPtr);
  RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  RTCHitN* hit = RTCRayHitN_HitN(arguments->rayhit, arguments->N);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const auto t = first_crossing(*geometry.sphere, ray, arguments->N, i);
    if (!t) continue;
    if (arguments->context->filter != nullptr) {
      offer(arguments, *t);
      continue;
    }
    RTCRayN_tfar(ray, arguments->N, i) = *t;
    RTCHitN_geomID(hit, arguments->N, i) = geometry.geometry_id;
    RTCHitN_primID(hit, arguments->N, i) = 0;
    RTCHitN_instID(hit, arguments->N, i, 0) = arguments->context->instID[0];
  }
}

// The corners of the group's box, each moved linearly between two time steps, stay in the box that
// moves linearly between theirs. Carrying a ray into the group moves it by a unit in the last place
// of its coordinates: as much is added all round.
void instance_bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& one =
      static_cast<const EmbreeInstances*>(arguments->geometryUserPtr)->all[arguments->primID];
  RTCBounds group;
  rtcGetSceneBounds(one.scene, &group);
  const Placement placement = one.instance->placement_at_step(arguments->timeStep);
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
  *arguments->bounds_o =
      outward(lower, upper, 4.0 * std::numeric_limits<float>::epsilon() * largest);
}

// Distances along the ray stay what they are, as the direction is carried along unnormalised.
void instance_intersect(const RTCIntersectFunctionNArguments* arguments) {
  // Geometry asks for single rays only, so N is 1.
  if (arguments->valid[0] == 0) return;
  const auto& one =
      static_cast<const EmbreeInstances*>(arguments->geometryUserPtr)->all[arguments->primID];
  auto& query = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
  const Placement placement = one.instance->placement(query.ray.time);
  if (!placement.valid()) return;
  const Vec3 origin =
      placement.point_to_group(Vec3{query.ray.org_x, query.ray.org_y, query.ray.org_z}).rounded();
  const Vec3 direction =
      (placement.inverse * Double3(Vec3{query.ray.dir_x, query.ray.dir_y, query.ray.dir_z}))
          .rounded();
  RTCRayHit in_group = query;
  in_group.ray.org_x = origin.x;
  in_group.ray.org_y = origin.y;
  in_group.ray.org_z = origin.z;
  in_group.ray.dir_x = direction.x;
  in_group.ray.dir_y = direction.y;
  in_group.ray.dir_z = direction.z;
  in_group.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  arguments->context->instID[0] = one.index;
  rtcIntersect1(one.scene, arguments->context, &in_group);
  arguments->context->instID[0] = RTC_INVALID_GEOMETRY_ID;
  if (in_group.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
  query.ray.tfar = in_group.ray.tfar;
  query.hit = in_group.hit;
}

template <class Data>
RTCGeometry user_geometry(RTCDevice device, const Data& data, std::size_t primitives,
                          std::size_t time_steps, RTCBoundsFunction bounds,
                          RTCIntersectFunctionN intersect) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(primitives));
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(time_steps));
  // Embree only hands the pointer back, and the callbacks above read.
  rtcSetGeometryUserData(geometry, const_cast<Data*>(&data));
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  return geometry;
}

}  // namespace

RTCGeometry new_geometry(RTCDevice device, const EmbreeSphere& sphere) {
  return user_geometry(device, sphere, 1, sphere.sphere->later_centres.size() + 1, sphere_bounds,
                       sphere_intersect);
}

RTCGeometry new_geometry(RTCDevice device, const EmbreeInstances& instances) {
  return user_geometry(device, instances, instances.all.size(),
                       instances.all.front().instance->time_steps(), instance_bounds,
                       instance_intersect);
}

}  // namespace nocturne

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "math/vec3.h"

namespace nocturne {

/// Where a ray met a surface. Holds what every photon needs; `Geometry::detail` tells the rest.
struct Hit {
  static constexpr std::uint32_t kNoInstance = ~0u;

  Vec3 position;
  /// Unit, geometric, in the scene, on the side that the shape's orientation says is out (not
  /// flipped towards the ray). Out of an instance is the image of out of the shape, also where the
  /// instance mirrors: a closed shape stays closed around the same inside.
  Vec3 normal;
  /// Index of the surface in the scene; of an instance, of the surface that it shows.
  std::uint32_t surface;
  /// Along the ray.
  float distance;
  /// How far along the normal the next ray must start so that it does not meet this surface again,
  /// metres.
  float clearance;
  /// Index of the instance, or kNoInstance.
  std::uint32_t instance;
  /// Index of the triangle; 0 on a sphere.
  std::uint32_t primitive;
  /// Barycentric coordinates of the triangle's second and third corner. On a sphere they say where
  /// for Geometry::detail only.
  float u, v;
};

/// 16 units in the last place of a coordinate. A point interpolated on its triangle in single
/// precision, and the plane that the next ray is tested against, are off by at most about ten of
/// the largest coordinate and the longest edge (rounding errors of the sums added up); 16 of both
/// clear that. Clearances are sums of such terms:
///   triangle  coordinate of the point + edge
///   instance  coordinate of the point + (coordinate + edge in the group) x stretch along the
///   normal,
///             as the next ray is rounded once in the scene and once in the group
///   sphere    coordinate of the point (the rest is in double precision)
inline constexpr float kClearanceUnits = 16.0f * std::numeric_limits<float>::epsilon() / 2.0f;

/// Double precision leaves an error of about 2^-52 of the largest number; with room.
inline constexpr double kDoubleUnits = 0x1p-44;

/// From a surface to where a ray that leaves it in `direction` starts, on the side that it leaves
/// on.
inline Vec3 step_off_surface(Vec3 normal, float clearance, Vec3 direction) {
  return (dot(normal, direction) >= 0.0f ? clearance : -clearance) * normal;
}

/// Origin of a ray that leaves the hit in `direction`.
inline Vec3 leave_surface(const Hit& hit, Vec3 direction) {
  return hit.position + step_off_surface(hit.normal, hit.clearance, direction);
}

/// Distance in `direction` from the surface to where a ray that leaves it starts, as of a plane: a
/// body thinner than that is not seen at grazing angles.
inline float ray_offset(const Hit& hit, Vec3 direction) {
  constexpr float kMinCosine = 1e-3f;
  return hit.clearance / std::max(kMinCosine, std::fabs(dot(hit.normal, direction)));
}

}  // namespace nocturne

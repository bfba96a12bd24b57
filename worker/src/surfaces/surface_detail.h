// What only some surfaces need to know about a hit: texture coordinates, shading normal, tangents.
#pragma once

#include "math/vec3.h"
#include "surfaces/hit.h"
#include "surfaces/instance.h"
#include "surfaces/shapes.h"

namespace nocturne {

struct SurfaceDetail {
  /// Texture coordinates; 0 where the shape has none.
  float u = 0.0f, v = 0.0f;
  /// Unit, as in the hit.
  Vec3 geometric_normal;
  /// Unit: interpolated between the vertices' normals, or the geometric one. On the side of the
  /// geometric normal: vertex normals that point to the other side are turned round.
  Vec3 shading_normal;
  /// Derivatives of the position by u and v, metres. Where the texture coordinates don't say (none,
  /// or all the same): unit vectors, orthonormal with the geometric normal.
  Vec3 dp_du, dp_dv;
  /// Texture units per metre, the root of texture area over area: a photon's footprint on the
  /// surface times this is its width in texture coordinates. 0 where there are none.
  float texture_per_metre = 0.0f;
};

/// Of a hit on this shape, in an instance at `placement` or, without one, in the scene itself.
SurfaceDetail surface_detail(const Shape& shape, const Placement* placement, const Hit& hit,
                             float time);

}  // namespace nocturne

// Shading normals from a texture: a map of normals, or of heights. Looked up without the footprint:
// reflected radiance is not linear in the normal, so the mean normal of a footprint reflects
// something else than the footprint does on average. The pixel's samples take that average.
#pragma once

#include <algorithm>
#include <cmath>

#include "parameters/texture_use.h"
#include "surfaces/shading_normal.h"

namespace nocturne {

class BumpMap {
 public:
  /// Tangent-space normals, each component 2 t - 1 of a channel t.
  static BumpMap of_normals(const TextureUse& use) { return {use, true}; }
  /// Heights, m.
  static BumpMap of_heights(const TextureUse& use) { return {use, false}; }

  Vec3 normal(const SurfaceDetail& detail, const SurfacePoint& point) const {
    if (map_) {
      const auto t = use_.rgb({point.u, point.v, 0.0f});
      return mapped_normal(detail, {2.0f * t[0] - 1.0f, 2.0f * t[1] - 1.0f, 2.0f * t[2] - 1.0f});
    }
    // Central differences, over a thousandth of the picture however often it is repeated.
    const float du = step(use_.scale_u), dv = step(use_.scale_v);
    const auto height = [&](float u, float v) { return use_.grey({u, v, 0.0f}); };
    return bumped_normal(
        detail, (height(point.u + du, point.v) - height(point.u - du, point.v)) / (2.0f * du),
        (height(point.u, point.v + dv) - height(point.u, point.v - dv)) / (2.0f * dv));
  }

 private:
  static float step(float scale) { return 0x1p-11f / std::max(1.0f, std::fabs(scale)); }

  BumpMap(const TextureUse& use, bool map) : use_(use), map_(map) {}

  TextureUse use_;
  bool map_;
};

}  // namespace nocturne

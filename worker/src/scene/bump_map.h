// Shading normals from a texture: a map of normals, or of heights.
#pragma once

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
      const auto t = use_.rgb(point);
      return mapped_normal(detail, {2.0f * t[0] - 1.0f, 2.0f * t[1] - 1.0f, 2.0f * t[2] - 1.0f});
    }
    // Central differences, over a thousandth of the texture or the footprint.
    const float step = std::max(kStep, 0.5f * point.width);
    const auto height = [&](float du, float dv) {
      return use_.grey({point.u + du, point.v + dv, point.width});
    };
    const float across = 0.5f / step;
    return bumped_normal(detail, across * (height(step, 0) - height(-step, 0)),
                         across * (height(0, step) - height(0, -step)));
  }

 private:
  static constexpr float kStep = 0x1p-11f;

  BumpMap(const TextureUse& use, bool map) : use_(use), map_(map) {}

  TextureUse use_;
  bool map_;
};

}  // namespace nocturne

// A texture as a surface uses it.
#pragma once

#include <array>
#include <cmath>

#include "parameters/surface_point.h"
#include "textures/texture.h"

namespace nocturne {

/// Looked up at the point's coordinates times scale plus offset; values times gain plus bias.
struct TextureUse {
  Texture texture;
  float scale_u = 1.0f, scale_v = 1.0f;
  float offset_u = 0.0f, offset_v = 0.0f;
  float gain = 1.0f, bias = 0.0f;

  float grey(const SurfacePoint& point) const {
    return value(texture.grey(u(point), v(point), width(point)));
  }
  std::array<float, 3> rgb(const SurfacePoint& point) const {
    return values(texture.rgb(u(point), v(point), width(point)));
  }
  /// Over the whole picture.
  std::array<float, 3> mean() const { return values(texture.mean()); }

 private:
  float u(const SurfacePoint& point) const { return point.u * scale_u + offset_u; }
  float v(const SurfacePoint& point) const { return point.v * scale_v + offset_v; }
  // Of the square with the footprint's area.
  float width(const SurfacePoint& point) const {
    return point.width * std::sqrt(std::fabs(scale_u * scale_v));
  }
  float value(float looked_up) const { return looked_up * gain + bias; }
  std::array<float, 3> values(const std::array<float, 3>& x) const {
    return {value(x[0]), value(x[1]), value(x[2])};
  }
};

}  // namespace nocturne

// Where on a surface something is asked, for what varies over it.
#pragma once

namespace nocturne {

struct SurfacePoint {
  /// Texture coordinates.
  float u = 0.0f, v = 0.0f;
  /// Width of the photon's footprint in texture coordinates.
  float width = 0.0f;
};

}  // namespace nocturne

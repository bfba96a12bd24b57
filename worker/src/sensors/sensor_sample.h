// What a sensor gives the tracer: where an adjoint photon starts, and where a forward photon
// counts.
#pragma once

#include <cstdint>
#include <optional>

#include "math/ray.h"

namespace nocturne {

struct SensorSample {
  Ray ray;
  /// The mean over samples of weight x radiance along the ray is what the pixel measures: 1 for a
  /// radiance; sr for an irradiance; m2 for an intensity.
  float weight;
  /// What a pixel sees of a surface across the ray at a distance: width + spread x distance,
  /// metres.
  float spread;
  float width;
  /// Of a film whose directions are drawn by the cosine with it, unit length: photons towards
  /// lights start there, too.
  std::optional<Vec3> normal = {};
};

/// Where a forward photon is counted: the sum over photons of flux x weight is what the pixel
/// measures.
struct SplatWeight {
  /// Row by row.
  std::uint32_t pixel;
  /// 1/m2 for an irradiance, 1/sr for an intensity.
  float weight;
  /// From the start of the segment, m; infinite where the photon leaves the scene.
  float distance;
};

/// How a forward photon gets from a place to a camera: the sum over photons of flux x (BSDF x
/// cosine) x weight is what the pixel measures.
struct CameraConnection {
  /// Unit length, and the distance to there, m.
  Vec3 direction;
  float distance;
  /// Row by row.
  std::uint32_t pixel;
  /// 1/m2.
  float weight;
};

}  // namespace nocturne

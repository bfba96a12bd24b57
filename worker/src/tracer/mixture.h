// The mixture density at a vertex: kernel, luminaires and uniform domain. Every part's density is
// evaluated whichever part drew the direction, so the estimate is unbiased for any weights. Morley
// et al. 2006, section 4.
#pragma once

#include <optional>

#include "kernels/kernel.h"
#include "math/frame.h"
#include "sampling/sequence.h"
#include "scene/scene.h"

namespace nocturne {

struct SampledDirection {
  Vec3 world, local;
  /// Density of the whole mixture, 1/sr, positive.
  float pdf;
};

template <BoundKernel Bound>
std::optional<SampledDirection> sample_mixture(const Scene& scene, const Bound& kernel,
                                               const Frame& frame, Vec3 position, Vec3 wo,
                                               float part, const Uniform4& u) {
  const MixtureWeights& weights = scene.options.mixture;
  SampledDirection drawn;
  if (part < weights.kernel) {
    const auto local = kernel.sample(wo, u[2], u[3]);
    if (!local) return std::nullopt;
    drawn.local = *local;
    drawn.world = frame.to_world(drawn.local);
  } else if (part < weights.kernel + weights.luminaires) {
    const auto world = scene.luminaire_directions.sample(position, u[1], u[2], u[3]);
    if (!world) return std::nullopt;
    drawn.world = *world;
    drawn.local = frame.to_local(drawn.world);
  } else {
    drawn.local = UniformHemisphere::sample(u[2], u[3]);
    drawn.world = frame.to_world(drawn.local);
  }
  drawn.pdf = weights.kernel * kernel.pdf(wo, drawn.local);
  if (weights.uniform > 0.0f) drawn.pdf += weights.uniform * UniformHemisphere::pdf(drawn.local);
  if (weights.luminaires > 0.0f) {
    drawn.pdf += weights.luminaires * scene.luminaire_directions.pdf(position, drawn.world);
  }
  if (!(drawn.pdf > 0.0f)) return std::nullopt;
  return drawn;
}

}  // namespace nocturne

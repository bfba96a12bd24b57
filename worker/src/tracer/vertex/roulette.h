// How likely photons survive a vertex (Morley et al. 2006, section 4;
// docs/decisions/0004-roulette-by-weight.md).
#pragma once

#include <algorithm>

#include "tracer/vertex/travel.h"

namespace nocturne {

/// In unbounded fog that absorbs little, photons would wander without end. From a distance r one
/// flight meets a ball of radius R with (R / r)^2, and a long walk with R / r. At the latter its
/// expected length would still be infinite, as a walk to r takes r^2 flights.
template <class Batch, int N>
float distance_roulette(const Batch& batch, const Group<N>& group, Vec3 position) {
  const auto& [centre, radius] = *batch.scene.all_in_fog;
  const Vec3 away = position - centre;
  return std::min(1.0f, largest(group.weight) * radius * radius / dot(away, away));
}

/// Interactions in a row that absorb nothing and only reflect or refract.
template <int N, class Kernel>
void count_caught(Group<N>& group, const Kernel& kernel, const Spectral<N>& albedo) {
  constexpr float kClear = 1.0f - 1e-6f;
  group.consecutive_specular =
      !kernel.smooth() && largest(albedo) >= kClear ? group.consecutive_specular + 1 : 0;
}

/// What ends photons that roulette by albedo would not, whatever their number of surfaces.
template <int N>
float survival_of_many(const Group<N>& group) {
  using Options = TracingOptions;
  const auto after = [](std::uint32_t least, std::uint32_t count) {
    return count > least ? 1.0f - 2.0f / static_cast<float>(std::min(count, Options::kSteadyFrom))
                         : 1.0f;
  };
  return std::min(after(Options::kSpecularRouletteAfter, group.consecutive_specular),
                  after(Options::kManyBounces, group.depth - group.collisions));
}

/// The paper's survival probability is H h. Times the weight that the photon carries, light photons
/// die and heavy ones stay (docs/decisions/0004-roulette-by-weight.md). One probability for the
/// group: it stays together as long as one of them is worth it. A photon that was drawn from a
/// mixture towards a small light weighs little and may bring much: where it may pass on its way,
/// what it has lost since it was drawn counts.
template <class Batch, int N, class Kernel>
float survival_at(const Batch& batch, Group<N>& group, const Vertex<N>& vertex,
                  const Kernel& kernel) {
  const TracingOptions& options = batch.options;
  float survival = 1.0f;
  if (group.depth > options.roulette_after) {
    Spectral<N> albedo = kernel.albedo(vertex.wo);
    count_caught(group, kernel, albedo);
    if (batch.kAdjoint && !group.inside.empty()) albedo *= square_of_index(batch, group);
    const bool from_mixture = batch.kAdjoint && options.estimator != Estimator::kTwoPhotons;
    const bool passes = from_mixture && batch.scene.materials[vertex.hit.surface].has_delta_lobe;
    const float h = options.h / (passes ? std::min(1.0f, group.mis.worth) : 1.0f);
    survival = std::min(1.0f, options.roulette_by_weight
                                  ? h * largest(albedo * group.weight)
                                  : options.h * largest(only(albedo, alive(group.weight))));
  }
  survival = std::min(survival, survival_of_many(group));
  if (batch.scene.all_in_fog) {
    survival = std::min(survival, distance_roulette(batch, group, vertex.hit.position));
  }
  return survival;
}

/// Of a photon that was sent to lights, where it meets a surface that has a delta lobe: by the
/// weight it has lost since. One that is totally reflected within glass again and again ends when
/// its medium has absorbed or scattered most of it, or by the number of its reflections.
template <class Batch, int N, class Kernel>
float survival_of_passing(const Batch& batch, Group<N>& group, const Vertex<N>& vertex,
                          const Kernel& kernel) {
  const Spectral<N> albedo = only(kernel.albedo(vertex.wo), alive(group.weight));
  const float left = largest(albedo * group.weight * square_of_index(batch, group));
  count_caught(group, kernel, albedo);
  return std::min({survival_of_many(group), largest(albedo), left / group.mis.worth});
}

}  // namespace nocturne

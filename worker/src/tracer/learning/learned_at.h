// The light that was learned at the place that a pixel shows
// (docs/decisions/0104-learned-light.md): to be looked at, not for tracing.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "luminaires/learned_light.h"
#include "scene/scene.h"

namespace nocturne {

struct LearnedAt {
  /// The shading normal on the side that is seen.
  Vec3 normal;
  /// Of the ray that meets the surface there.
  Vec3 direction;
  /// Mirrors and clear boundaries on the path to it.
  std::uint32_t passed;
  /// None where nothing was learned nearby.
  std::vector<LearnedLight::Cone> cones;
};

/// Of the first surface that is no mirror and not clear, on the ray through the middle of pixel,
/// lens and shutter. Empty where the ray meets none. Media are not looked at.
std::optional<LearnedAt> learned_at(const Scene& scene, Film film, std::uint32_t x,
                                    std::uint32_t y);

}  // namespace nocturne

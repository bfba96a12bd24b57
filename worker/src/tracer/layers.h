// Layers of an image: no light, but what the surfaces that pixels see are like, where they are and
// which they are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace nocturne {

/// A pixel's numbers, in the order in which files hold them. Albedo, normal and emission are means
/// over samples, with 0 where there is no surface; all others are of the middle of pixel, lens and
/// shutter.
struct PixelLayers {
  /// Linear sRGB, as white light of equal energy shows it.
  std::array<float, 3> albedo{};
  /// The shading normal, on the side that is seen.
  std::array<float, 3> normal{};
  /// Along the ray, metres.
  float depth = kNoDepth;
  std::array<float, 3> position{};
  /// Index of the surface + 1, and surfaces are followed by instances; 0: nothing is seen.
  float object = 0.0f;
  /// Index of the kernel + 1.
  float material = 0.0f;
  /// The part of the samples that meet a luminaire's light: on the first surface that is seen, or
  /// on one before it that lets them straight through.
  float emission = 0.0f;

  /// What Blender writes where there is nothing, too.
  static constexpr float kNoDepth = 1e10f;
};
inline constexpr std::size_t kLayerValues = 13;
static_assert(sizeof(PixelLayers) == kLayerValues * sizeof(float));

/// Row by row; the same for any number of threads. Sees past what lets rays straight through, as
/// panes and holes do, and past media.
std::vector<PixelLayers> trace_layers(const Scene& scene, Film film, std::uint32_t samples,
                                      unsigned threads);

}  // namespace nocturne

// What patches of the sky, or suns, bring, counted beside what the sensor sees.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "luminaires/sky_patches.h"
#include "math/vec3.h"

namespace nocturne {

struct DaylightCoefficients {
  static constexpr std::uint32_t kNotCounted = ~0u;

  SkyPatches patches;
  /// By patch: its place among those that are counted, or kNotCounted.
  std::vector<std::uint32_t> places = {};
  std::uint32_t counted = 0;
  /// What came straight, or through windows alone, is left out.
  bool reflected_alone = false;
  /// Unit vectors. Where there are any, these are counted instead of patches.
  std::vector<Vec3> suns = {};

  /// Numbers of each pixel.
  std::size_t count() const { return suns.empty() ? counted : suns.size() + 1; }
};

}  // namespace nocturne

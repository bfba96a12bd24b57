// Daylight coefficients: what patches of the sky and suns bring to each pixel of meters, from one
// render for all skies (P. Tregenza, I. Waters, "Daylight coefficients", Lighting Research and
// Technology 15 (1983) 65).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "luminaires/sky_patches.h"
#include "scene/scene.h"
#include "sensors/film.h"

namespace nocturne {

struct DaylightRequest {
  Film film;
  std::uint32_t first_sample, end_sample;
  SkyPatches patches;
  /// Unit vectors towards suns, and the radius of their discs, rad.
  std::vector<Vec3> suns;
  float sun_radius;
};

/// Sums over samples, in Y.
struct DaylightSums {
  /// By pixel, then: what comes straight, through nothing but windows, and all else; then by patch.
  /// Of a sky of the scene's environment.
  std::vector<double> patches;
  /// By pixel, then by sun: what comes straight from a sun that gives a plane across its beam the
  /// illuminance 1.
  std::vector<double> suns;
  /// By pixel, what that illuminance was for the drawn wavelengths; its mean is 1.
  std::vector<double> across;
  std::uint64_t photons = 0, rays = 0, invalid_samples = 0, truncated_paths = 0;
};

/// Of a sensor of meters and a scene whose sky is the same from everywhere. Throws
/// std::invalid_argument where it is not so.
DaylightSums trace_daylight(Scene& scene, const DaylightRequest& request, unsigned threads,
                            const std::function<void(double)>& progress);

}  // namespace nocturne

// Daylight coefficients: what patches of the sky and suns bring to each pixel of meters, from one
// render for all skies (P. Tregenza, I. Waters, "Daylight coefficients", Lighting Research and
// Technology 15 (1983) 65).
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "luminaires/sky_patches.h"
#include "scene/daylight_coefficients.h"
#include "scene/scene.h"
#include "sensors/film.h"
#include "tile/tile_sums.h"

namespace nocturne {

/// Of the Sun's disc at the Earth's mean distance, rad.
inline constexpr float kSunRadius = 0.2666f * kPi / 180.0f;

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

struct DaylightTile {
  TileSums sums;
  /// Of each pixel side by side, row by row: sums over samples, in Y.
  std::vector<double> coefficients;
};

/// The range of a tile: coefficients beside X, Y, Z of the even sky, or of the mean of the suns.
/// They are those of trace_daylight, bit for bit. Throws std::invalid_argument where they would be
/// too many, TracingStopped.
DaylightTile trace_daylight_tile(const Scene& scene, const DaylightCoefficients& daylight,
                                 Film film, const TileRange& range, const std::stop_token& stop);

/// Of a sensor of meters and a scene whose sky is the same from everywhere. Throws
/// std::invalid_argument where it is not so.
DaylightSums trace_daylight(Scene& scene, const DaylightRequest& request, unsigned threads,
                            const std::function<void(double)>& progress);

}  // namespace nocturne

#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "tile/tile_sums.h"

namespace nocturne {

/// What an image says of its making.
struct ImageProvenance {
  std::string scene_sha256;
  /// The plan as JSON, as the service spells it.
  std::string plan;
  std::uint32_t engine;
  std::string floating_point_profile;
  /// What Y measures, its unit, and that of a further response without a unit.
  std::string quantity, unit, response_unit;
  /// Photons that a limit of the tracer ended; told where there are any.
  std::uint64_t truncated_paths = 0;
  /// How the scene is traced and why, where a pilot chose.
  std::string way = {};
  /// What a pilot found that the image may not show: a sentence a line; and rectangles in which
  /// light may be missing, "x y width height part" a line.
  std::string warnings = {}, unmet_parts = {};
  /// Which the scene is about.
  std::string wavelengths = "360 to 830 nm";
  /// What the sensor measures where, as JSON.
  std::string instruments = {};
};

/// Writes means and errors of a film whose tiles have edges of `tile_size` pixels, over `samples`
/// samples of every pixel. Float channels: X, Y, Z (Y in cd/m2) and one with the name of each
/// further response; the standard error of each, NAME.stderr; XY.correlation, XZ.correlation and
/// YZ.correlation of their errors; X.ownRatio and so on, the variance by the pixel's own
/// samples over that of NAME.stderr; X.blockRatio and so on, the joint variance
/// of a block's pixels over the sum of their variances, X.tileRatio and so on, that of a
/// tile over those of its blocks, and XY.blockCorrelation and so on of errors of the joint
/// sums of a block's pixels; linear sRGB in R, G, B for viewers, unless a response has one of these
/// names. With further responses the attribute nocturne:correlations has, of each tile of films of
/// at most kMostCorrelations numbers, how the means of all values go together: as
/// nocturne_scene/response_correlations.py has it. Another channel is n (uint). Throws
/// std::invalid_argument where names are more or fewer than the responses or two channels have one
/// name, and another std::exception where the file can't be written.
void write_exr(const std::filesystem::path& path, const TileSums& film, std::uint32_t tile_size,
               std::span<const std::string> further_responses, std::uint32_t samples,
               const ImageProvenance& provenance);

}  // namespace nocturne

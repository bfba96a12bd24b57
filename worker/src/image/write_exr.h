#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

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
};

/// Writes means and errors from sums (per pixel, row by row: sum X, Y, Z, Y^2 and one for each
/// further response) over `samples` samples of every pixel: channels X, Y, Z (Y in cd/m2), Y.stderr
/// (float), n (uint), one with the name of each further response (float), and linear sRGB in R, G,
/// B (float) for viewers, unless a response has one of these names. Throws std::invalid_argument
/// where sums are more or fewer than that or two channels have one name, and another std::exception
/// where the file can't be written.
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const double> sums, std::span<const std::string> further_responses,
               std::uint32_t samples, const ImageProvenance& provenance);

}  // namespace nocturne

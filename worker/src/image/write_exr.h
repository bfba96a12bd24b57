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
};

/// Writes means and errors from sums (sum X, Y, Z, Y^2 per pixel, row by row) over `samples`
/// samples of every pixel: channels X, Y, Z (Y in cd/m2), Y.stderr (float) and n (uint). Throws
/// std::exception where the file can't be written.
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const double> sums, std::uint32_t samples,
               const ImageProvenance& provenance);

}  // namespace nocturne

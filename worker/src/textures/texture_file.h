// A texture as the scene compiler writes it (scene/nocturne_scene/textures/texture_files.py),
// mapped into memory: all levels of a picture as raw numbers, little endian. In this order:
// - "NOCTEXEL", then as uint32 each: version, width, height, channels (1 or 3), Numbers of the
//   finest level, Numbers of all others (not codes), how many levels there are;
// - of codes alone: the 256 float32 that they stand for;
// - the levels, the finest first, each from the next multiple of 64 bytes on. One is half as wide
//   and as high as the one before, rounded down, and at least 1; the last one is 1 x 1.
// A level is one strip of 64 columns after another, of all its rows from the top down. A strip has
// a column more, the first one of the strip to the right, and a row more, the level's top row: so
// the four texels of a lookup lie in one strip, also where the picture repeats. Strips of a level
// that is narrower have its width and that one column; the texels right of a level's end are zero.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace nocturne {

struct TextureFile {
  static constexpr std::uint32_t kVersion = 1;
  static constexpr int kLogStrip = 6, kStrip = 1 << kLogStrip;

  /// And how many bytes each has.
  enum class Numbers : std::uint32_t { kCodes = 1, kHalf = 2, kFloat = 4 };

  struct Level {
    int columns, rows;
    /// The same, and the lesser of both.
    float width, height, edge;
    Numbers numbers;
    std::uint32_t row_bytes;
    std::size_t strip_bytes;
    const std::byte* texels;
  };

  std::shared_ptr<const std::byte> bytes;
  int channels;
  std::vector<Level> levels;
  /// What codes stand for.
  const float* table;
};

/// Of a whole file of `channels`, all of whose numbers are finite and not beyond 1e38, so that no
/// difference of two is. Throws std::invalid_argument for anything else, in words.
TextureFile map_texture(const std::filesystem::path& file, int channels);

}  // namespace nocturne

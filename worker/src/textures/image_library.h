// What textures need of the image library. It is a module that is loaded when the first texture is
// opened: most scenes have none, and loading it takes longer than many a preview.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "textures/texture.h"

namespace nocturne {

struct OpenedImage {
  /// Lives as long as the process.
  void* handle;
  int channels;
  /// Of half numbers, not of float.
  bool half;
  struct Level {
    int width, height;
  };
  /// The finest first; each is half as wide and as high as the one before, rounded down.
  std::vector<Level> levels;
  std::array<float, 3> mean;
};

/// Texels of a level: columns from x on, rows from y on, the top row first.
struct TexelRectangle {
  int x, y, width, height;
};

/// All throw TextureError.
struct ImageLibrary {
  OpenedImage (*open)(const std::filesystem::path& file, int channels);
  /// All channels of a rectangle within a level, in the file's own numbers; rows begin `row_bytes`
  /// apart. What is not finite, or beyond 1e38, is refused.
  void (*read)(const OpenedImage& image, std::size_t level, const TexelRectangle& rectangle,
               std::byte* texels, std::size_t row_bytes);
  void (*set_memory)(std::uint64_t bytes);
  std::uint64_t (*memory_used)();
};

/// What the module exports.
inline constexpr const char* kImageLibraryModule = "nocturne_image_library.so";
extern "C" const ImageLibrary* nocturne_image_library();

}  // namespace nocturne

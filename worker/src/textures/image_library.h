// What textures need of the image library. It is a module that is loaded when the first texture is
// opened: most scenes have none, and loading it takes longer than many a preview.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "textures/texture.h"

namespace nocturne {

struct OpenedImage {
  /// Lives as long as the process.
  void* handle;
  std::array<float, 3> mean;
};

/// As Texture's members of the same names; all throw TextureError.
struct ImageLibrary {
  OpenedImage (*open)(const std::filesystem::path& file, int channels);
  void (*look_up)(void* handle, TextureWrap wrap, float u, float v, float width, int count,
                  float* result);
  void (*set_memory)(std::uint64_t bytes);
  std::uint64_t (*memory_used)();
};

/// What the module exports.
inline constexpr const char* kImageLibraryModule = "nocturne_image_library.so";
extern "C" const ImageLibrary* nocturne_image_library();

}  // namespace nocturne

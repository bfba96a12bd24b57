// Image files looked up with filtering, out of tiles in memory that all threads share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>

namespace nocturne {

/// A file that is no texture, or that can't be read any more.
class TextureError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Coordinates outside [0, 1].
enum class TextureWrap { kRepeat, kClamp };
/// What is looked up: the mean over a footprint, or the picture as it is.
enum class TextureFilter { kFootprint, kSharp };

class Texels;

/// A handle, cheap to copy. A lookup is a pure function of its arguments: neither thread nor what
/// the cache holds change a bit of it.
class Texture {
 public:
  /// An OpenEXR file, tiled, with all MIP levels, `channels` (1 or 3) of half or float. The name
  /// needs no extension. Tiles are read when they are looked up: the file must stay where and as it
  /// is until the last lookup. Throws TextureError.
  Texture(const std::filesystem::path& file, int channels, TextureWrap wrap,
          TextureFilter filter = TextureFilter::kFootprint);

  int channels() const;

  /// u from left to right and v from the bottom row up, 0 and 1 at the picture's edges; what is not
  /// finite counts as 0. Bilinear within a level, linear between the two levels whose texels are
  /// next to `width` wide (in the unit of u and v; 0, and wherever it is sharp: the finest level).
  /// Finite. Throws TextureError if the file can't be read any more or holds what is not finite: a
  /// photon that goes on with something else would give a wrong image.
  float grey(float u, float v, float width) const;
  /// Of a texture of three channels.
  std::array<float, 3> rgb(float u, float v, float width) const;

  /// Of the coarsest level; with one channel, three times the same.
  std::array<float, 3> mean() const;

 private:
  float filtered(float width) const { return filter_ == TextureFilter::kFootprint ? width : 0.0f; }

  std::shared_ptr<const Texels> texels_;
  TextureFilter filter_;
};

/// Bound of the tiles held in memory, of all textures of the process.
inline constexpr std::uint64_t kTextureMemoryBytes = std::uint64_t{256} << 20;

/// Another bound. Does not change what is looked up; what is held already stays.
void set_texture_memory(std::uint64_t bytes);
/// Held now.
std::uint64_t texture_memory_used();

}  // namespace nocturne

// Pictures over surfaces, looked up with filtering, out of files that are mapped into memory.
#pragma once

#include <array>
#include <filesystem>
#include <memory>

namespace nocturne {

struct TextureFile;

/// Coordinates outside [0, 1].
enum class TextureWrap { kRepeat, kClamp };
/// The value looked up: the mean over a footprint, or the picture as it is.
enum class TextureFilter { kFootprint, kSharp };

/// A handle, cheap to copy. A lookup is a pure function of its arguments.
class Texture {
 public:
  /// A texture file (textures/texture_file.h) of `channels`, 1 or 3, mapped as files/mapped_file.h
  /// says. Throws std::invalid_argument, in words.
  Texture(const std::filesystem::path& file, int channels, TextureWrap wrap,
          TextureFilter filter = TextureFilter::kFootprint);

  int channels() const;

  /// u from left to right and v from the bottom row up, 0 and 1 at the picture's edges; what is not
  /// finite counts as 0. Bilinear within a level, linear between the two levels whose texels are
  /// next to `width` wide (in the unit of u and v; 0, and wherever it is sharp: the finest level).
  /// Finite.
  float grey(float u, float v, float width) const;
  /// Of a texture of three channels.
  std::array<float, 3> rgb(float u, float v, float width) const;

  /// Of the coarsest level; with one channel, three times the same.
  std::array<float, 3> mean() const;

 private:
  float filtered(float width) const { return filter_ == TextureFilter::kFootprint ? width : 0.0f; }

  std::shared_ptr<const TextureFile> file_;
  TextureWrap wrap_;
  TextureFilter filter_;
};

}  // namespace nocturne

// Texels of an image in memory, and interpolation between them. A lookup finds its four texels side
// by side: tiles hold one column and one row of their neighbours.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "textures/image_library.h"
#include "textures/texture.h"

namespace nocturne {

class Texels {
 public:
  Texels(const ImageLibrary& library, OpenedImage image, TextureWrap wrap);
  ~Texels();
  Texels(const Texels&) = delete;
  Texels& operator=(const Texels&) = delete;

  /// As Texture::grey and Texture::rgb, with that many channels.
  template <int kChannels>
  std::array<float, kChannels> at(float u, float v, float footprint) const;

  int channels() const { return image_.channels; }
  const std::array<float, 3>& mean() const { return image_.mean; }

  /// Of all images of the process; tiles that are there stay.
  static void set_memory(std::uint64_t bytes);
  static std::uint64_t memory_used();

 private:
  // Edge of a tile without its neighbours' texels.
  static constexpr int kLogEdge = 6, kEdge = 1 << kLogEdge;

  struct Level {
    float width, height;
    int columns, rows;
    // The lesser of width and height.
    float edge;
    // Of all its tiles: tiles in a row of them, the first one's number, bytes of a row of texels.
    std::uint32_t across;
    std::uint32_t first_tile;
    std::uint32_t row_bytes;
  };
  // Four texels: the second of a row follows the first.
  struct Square {
    const std::byte *top, *bottom;
  };
  // Where they are if no tile has them.
  struct Room {
    alignas(float) std::array<std::byte, 2 * 2 * 3 * sizeof(float)> texels;
  };

  // s from left to right and t from the top row down, within [0, 1].
  template <int kChannels>
  std::array<float, kChannels> interpolated(const Level& level, float s, float t) const;
  Square square(const Level& level, int x, int y, Room& room) const {
    const std::size_t tile = level.first_tile +
                             static_cast<std::uint32_t>(y >> kLogEdge) * level.across +
                             static_cast<std::uint32_t>(x >> kLogEdge);
    const std::byte* texels = tiles_[tile].load(std::memory_order_acquire);
    if (texels == nullptr) [[unlikely]] {
      texels = load(level, tile, x, y);
      if (texels == nullptr) return read_square(level, x, y, room);
    }
    const std::byte* top = texels + static_cast<std::uint32_t>(y & (kEdge - 1)) * level.row_bytes +
                           static_cast<std::uint32_t>(x & (kEdge - 1)) * texel_bytes_;
    return {top, top + level.row_bytes};
  }
  // Nothing where memory does not hold one more.
  const std::byte* load(const Level& level, std::size_t tile, int x, int y) const;
  Square read_square(const Level& level, int x, int y, Room& room) const;
  // A rectangle that reaches at most one texel beyond the level, to the right and below.
  void read(const Level& level, const TexelRectangle& rectangle, std::byte* texels,
            std::size_t row_bytes) const;

  const ImageLibrary& library_;
  OpenedImage image_;
  TextureWrap wrap_;
  std::uint32_t texel_bytes_;
  std::vector<Level> levels_;
  std::size_t tile_count_ = 0;
  mutable std::mutex loading_;
  mutable std::uint64_t held_bytes_ = 0;
  std::unique_ptr<std::atomic<std::byte*>[]> tiles_;
};

}  // namespace nocturne

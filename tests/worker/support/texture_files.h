// Texture files as the scene compiler makes them, named by digits without an extension, as blobs
// are. Gone with the object.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nocturne/v1/scene.pb.h"
#include "scene/scene_error.h"

namespace nocturne::test {

struct Picture {
  int width, height, channels;
  /// Rows from the top down.
  std::vector<float> values;

  /// A picture of `value(x, y)`, one channel.
  template <class F>
  static Picture of(int width, int height, const F& value) {
    Picture picture{width, height, 1, {}};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) picture.values.push_back(value(x, y));
    }
    return picture;
  }
};

class TextureFiles {
 public:
  TextureFiles();
  ~TextureFiles();
  TextureFiles(const TextureFiles&) = delete;
  TextureFiles& operator=(const TextureFiles&) = delete;

  /// Tiled, with MIP levels, float.
  std::filesystem::path write(const Picture& picture) { return write(picture, true); }
  /// A plain EXR: neither.
  std::filesystem::path write_plain(const Picture& picture) { return write(picture, false); }

  /// Writes it and returns its index in the message's list.
  std::uint32_t add(v1::CompiledScene& message, const Picture& picture, bool clamp = false);
  /// A use of it: gain 1, scale 1.
  v1::TextureUse use(v1::CompiledScene& message, const Picture& picture, bool clamp = false);

  /// Of files added.
  FindBlob find_blob() const;
  std::filesystem::path next_path();
  std::string last_digest() const { return digest_; }

 private:
  std::filesystem::path write(const Picture& picture, bool texture);

  std::filesystem::path folder_;
  std::string digest_;  // 32 bytes, counted up
};

}  // namespace nocturne::test

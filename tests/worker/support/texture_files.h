// Texture files in the layout of textures/texture_file.h, named by digits without an extension, as
// blobs are. Gone with the object.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nocturne/v1/scene.pb.h"
#include "scene/scene_error.h"
#include "textures/texture_file.h"

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

  /// Coarser levels are means of the pixels below theirs. Codes are whole numbers of 0 to 255, and
  /// stand for themselves.
  std::filesystem::path write(const Picture& picture,
                              TextureFile::Numbers numbers = TextureFile::Numbers::kFloat);

  /// Writes it and returns its index in the message's list.
  std::uint32_t add(v1::CompiledScene& message, const Picture& picture, bool clamp = false);
  /// A use of it: gain 1, scale 1.
  v1::TextureUse use(v1::CompiledScene& message, const Picture& picture, bool clamp = false);

  /// Of files added.
  FindBlob find_blob() const;
  std::filesystem::path next_path();
  std::string last_digest() const { return digest_; }

 private:
  std::filesystem::path folder_;
  std::string digest_;  // 32 bytes, counted up
};

}  // namespace nocturne::test

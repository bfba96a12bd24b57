#include "support/texture_files.h"

#include <immintrin.h>
#include <stdlib.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "digest/sha256.h"

namespace nocturne::test {
namespace {

struct Bytes {
  std::string all;

  template <class T>
  void add(const T& value) {
    all.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add(float value, TextureFile::Numbers numbers) {
    switch (numbers) {
      case TextureFile::Numbers::kCodes:
        return add(static_cast<std::uint8_t>(value));
      case TextureFile::Numbers::kHalf:
        return add(_cvtss_sh(value, _MM_FROUND_TO_NEAREST_INT));
      case TextureFile::Numbers::kFloat:
        return add(value);
    }
  }
};

float texel(const Picture& picture, int x, int y, int channel) {
  return picture
      .values[static_cast<std::size_t>((y * picture.width + x) * picture.channels + channel)];
}

void add_level(Bytes& bytes, const Picture& level, TextureFile::Numbers numbers) {
  constexpr int kStrip = TextureFile::kStrip;
  bytes.all.resize((bytes.all.size() + 63) / 64 * 64);
  for (int left = 0; left < level.width; left += kStrip) {
    for (int y = 0; y <= level.height; ++y) {
      for (int x = left; x <= left + std::min(level.width, kStrip); ++x) {
        for (int c = 0; c < level.channels; ++c) {
          const float value =
              x > level.width ? 0.0f : texel(level, x % level.width, y % level.height, c);
          bytes.add(value, numbers);
        }
      }
    }
  }
}

Picture coarser(const Picture& fine) {
  Picture coarse{std::max(fine.width / 2, 1), std::max(fine.height / 2, 1), fine.channels, {}};
  for (int y = 0; y < coarse.height; ++y) {
    const int top = y * fine.height / coarse.height, bottom = (y + 1) * fine.height / coarse.height;
    for (int x = 0; x < coarse.width; ++x) {
      const int left = x * fine.width / coarse.width, right = (x + 1) * fine.width / coarse.width;
      for (int c = 0; c < fine.channels; ++c) {
        double sum = 0.0;
        for (int j = top; j < bottom; ++j) {
          for (int i = left; i < right; ++i) sum += static_cast<double>(texel(fine, i, j, c));
        }
        coarse.values.push_back(static_cast<float>(sum / ((bottom - top) * (right - left))));
      }
    }
  }
  return coarse;
}

}  // namespace

TextureFiles::TextureFiles() : digest_(32, '\0') {
  std::string pattern = (std::filesystem::temp_directory_path() / "nocturne-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = pattern;
}

TextureFiles::~TextureFiles() { std::filesystem::remove_all(folder_); }

std::filesystem::path TextureFiles::next_path() {
  ++digest_[0];
  return folder_ / to_hex(digest_);
}

std::filesystem::path TextureFiles::write(const Picture& picture, TextureFile::Numbers numbers) {
  using Numbers = TextureFile::Numbers;
  const Numbers coarser_numbers = numbers == Numbers::kCodes ? Numbers::kHalf : numbers;
  Bytes bytes;
  for (const char c : std::string("NOCTEXEL")) bytes.add(c);
  const auto edge = static_cast<unsigned>(std::max(picture.width, picture.height));
  const std::initializer_list<int> header{static_cast<int>(TextureFile::kVersion),
                                          picture.width,
                                          picture.height,
                                          picture.channels,
                                          static_cast<int>(numbers),
                                          static_cast<int>(coarser_numbers),
                                          static_cast<int>(std::bit_width(edge))};
  for (const int number : header) bytes.add(number);
  if (numbers == Numbers::kCodes) {
    for (int code = 0; code < 256; ++code) bytes.add(static_cast<float>(code));
  }
  Picture level = picture;
  while (true) {
    add_level(bytes, level, numbers);
    if (level.width == 1 && level.height == 1) break;
    level = coarser(level);
    numbers = coarser_numbers;
  }
  const auto path = next_path();
  std::ofstream(path, std::ios::binary).write(bytes.all.data(), std::ssize(bytes.all));
  return path;
}

std::uint32_t TextureFiles::add(v1::CompiledScene& message, const Picture& picture, bool clamp) {
  write(picture);
  auto& texture = *message.add_textures();
  texture.set_blob(digest_);
  texture.set_channels(static_cast<std::uint32_t>(picture.channels));
  texture.set_clamp(clamp);
  return static_cast<std::uint32_t>(message.textures_size()) - 1;
}

v1::TextureUse TextureFiles::use(v1::CompiledScene& message, const Picture& picture, bool clamp) {
  v1::TextureUse use;
  use.set_texture(add(message, picture, clamp));
  use.set_scale_u(1);
  use.set_scale_v(1);
  use.set_gain(1);
  return use;
}

FindBlob TextureFiles::find_blob() const {
  return [folder = folder_](const std::string& sha256) { return folder / sha256; };
}

}  // namespace nocturne::test

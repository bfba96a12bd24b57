#include "textures/texture.h"

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "textures/texture_file.h"

namespace nocturne {
namespace {

using Level = TextureFile::Level;

// To where the picture is, so that no large number meets an integer.
float wrapped(float x, TextureWrap wrap) {
  if (!std::isfinite(x)) return 0.0f;
  return wrap == TextureWrap::kClamp ? std::clamp(x, 0.0f, 1.0f) : x - std::floor(x);
}

float between(float a, float b, float part) { return a + part * (b - a); }

// Of four texels, the second of a row next to the first.
template <class Number, int kChannels, class Read>
std::array<float, kChannels> mixed(const std::byte* top, std::uint32_t row_bytes, float right,
                                   float down, const Read& read) {
  const auto row = [&](const std::byte* texels, int channel) {
    const Number* first = reinterpret_cast<const Number*>(texels) + channel;
    return between(read(first[0]), read(first[kChannels]), right);
  };
  std::array<float, kChannels> values;
  for (int c = 0; c < kChannels; ++c) {
    values[static_cast<std::size_t>(c)] = between(row(top, c), row(top + row_bytes, c), down);
  }
  return values;
}

struct Lookup {
  const TextureFile& file;
  TextureWrap wrap;

  template <int kChannels>
  std::array<float, kChannels> at(float u, float v, float footprint) const {
    // Texels are counted from the top row down.
    const float s = wrapped(u, wrap), t = 1.0f - wrapped(v, wrap);
    // Beyond an edge that is held, that much of both sides of a footprint sees the edge alone: a
    // coarser level there would mix in texels that are farther inside.
    const float beyond = wrap == TextureWrap::kClamp && std::isfinite(u) && std::isfinite(v)
                             ? std::max(std::abs(u - s), std::abs(1.0f - v - t))
                             : 0.0f;
    const float inside = footprint - 2.0f * beyond;
    // Beyond one picture there is nothing coarser.
    const float width = inside > 0.0f ? std::min(inside, 1.0f) : 0.0f;
    // The finest level whose texels are as wide as the footprint: it, and the one before.
    const auto fits = [&](const Level& level) { return width * level.edge <= 1.0f; };
    if (fits(file.levels.front())) return interpolated<kChannels>(file.levels.front(), s, t);
    const auto coarser = std::ranges::find_if(file.levels, fits);
    if (coarser == file.levels.end()) return interpolated<kChannels>(file.levels.back(), s, t);
    // From half a texel of it, which is one of the finer level, to a whole one.
    const float part = std::max(2.0f * width * coarser->edge - 1.0f, 0.0f);
    auto values = interpolated<kChannels>(*(coarser - 1), s, t);
    const auto coarse = interpolated<kChannels>(*coarser, s, t);
    for (std::size_t c = 0; c < kChannels; ++c) values[c] = between(values[c], coarse[c], part);
    return values;
  }

  // s from left to right and t from the top row down, within [0, 1].
  template <int kChannels>
  std::array<float, kChannels> interpolated(const Level& level, float s, float t) const {
    // The texel whose centre is left of the place, or above it, and how far the place is from
    // there. The file holds the texel after the last one where the picture repeats.
    const auto before = [&](float along, float size, int count) {
      const float place = along * size - 0.5f;
      const float whole = std::floor(place);
      const int index = static_cast<int>(whole);
      const float part = place - whole;
      if (wrap == TextureWrap::kRepeat) return std::pair(index < 0 ? count - 1 : index, part);
      return index < 0 || index == count - 1 ? std::pair(std::max(index, 0), 0.0f)
                                             : std::pair(index, part);
    };
    const auto [x, right] = before(s, level.width, level.columns);
    const auto [y, down] = before(t, level.height, level.rows);
    constexpr int kMask = TextureFile::kStrip - 1;
    const std::byte* top =
        level.texels + static_cast<std::uint32_t>(x >> TextureFile::kLogStrip) * level.strip_bytes +
        static_cast<std::size_t>(y) * level.row_bytes;
    const auto mix = [&]<class Number>(Number, const auto& read) {
      const auto column = static_cast<std::uint32_t>(x & kMask) * kChannels;
      return mixed<Number, kChannels>(top + column * sizeof(Number), level.row_bytes, right, down,
                                      read);
    };
    switch (level.numbers) {
      case TextureFile::Numbers::kCodes:
        return mix(std::uint8_t{}, [table = file.table](auto code) { return table[code]; });
      case TextureFile::Numbers::kHalf:
        return mix(std::uint16_t{}, [](auto half) { return _cvtsh_ss(half); });
      case TextureFile::Numbers::kFloat:
        break;
    }
    return mix(float{}, [](auto number) { return number; });
  }
};

}  // namespace

Texture::Texture(const std::filesystem::path& file, int channels, TextureWrap wrap,
                 TextureFilter filter)
    : file_(std::make_shared<const TextureFile>(map_texture(file, channels))),
      wrap_(wrap),
      filter_(filter) {}

int Texture::channels() const { return file_->channels; }

float Texture::grey(float u, float v, float width) const {
  return Lookup{*file_, wrap_}.at<1>(u, v, filtered(width))[0];
}

std::array<float, 3> Texture::rgb(float u, float v, float width) const {
  return Lookup{*file_, wrap_}.at<3>(u, v, filtered(width));
}

std::array<float, 3> Texture::mean() const {
  const auto& coarsest = file_->levels.back();
  const Lookup lookup{*file_, wrap_};
  if (channels() == 3) return lookup.interpolated<3>(coarsest, 0.5f, 0.5f);
  std::array<float, 3> mean;
  mean.fill(lookup.interpolated<1>(coarsest, 0.5f, 0.5f)[0]);
  return mean;
}

}  // namespace nocturne

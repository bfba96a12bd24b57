#include "textures/texels.h"

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nocturne {
namespace {

std::atomic<std::uint64_t> most_bytes = 0, used_bytes = 0;

// Whether there was room for them.
bool take_memory(std::uint64_t bytes) {
  if (used_bytes.fetch_add(bytes) + bytes <= most_bytes) return true;
  used_bytes -= bytes;
  return false;
}

float number(const float* texel) { return *texel; }
float number(const std::uint16_t* texel) { return _cvtsh_ss(*texel); }

// To where the picture is, so that no large number meets an integer.
float wrapped(float x, TextureWrap wrap) {
  if (!std::isfinite(x)) return 0.0f;
  return wrap == TextureWrap::kClamp ? std::clamp(x, 0.0f, 1.0f) : x - std::floor(x);
}

float between(float a, float b, float part) { return a + part * (b - a); }

template <class Number, int kChannels>
std::array<float, kChannels> mixed(const std::byte* top, const std::byte* bottom, float right,
                                   float down) {
  const auto row = [&](const std::byte* texels, int channel) {
    const Number* first = reinterpret_cast<const Number*>(texels) + channel;
    return between(number(first), number(first + kChannels), right);
  };
  std::array<float, kChannels> values;
  for (int c = 0; c < kChannels; ++c) {
    values[static_cast<std::size_t>(c)] = between(row(top, c), row(bottom, c), down);
  }
  return values;
}

}  // namespace

Texels::Texels(const ImageLibrary& library, OpenedImage image, TextureWrap wrap)
    : library_(library),
      image_(std::move(image)),
      wrap_(wrap),
      texel_bytes_(static_cast<std::uint32_t>(image_.channels) * (image_.half ? 2 : 4)) {
  const auto tiles = [](int texels) {
    return static_cast<std::uint32_t>((texels + kEdge - 1) >> kLogEdge);
  };
  for (const auto& [width, height] : image_.levels) {
    levels_.push_back(
        {.width = static_cast<float>(width),
         .height = static_cast<float>(height),
         .columns = width,
         .rows = height,
         .edge = static_cast<float>(std::min(width, height)),
         .across = tiles(width),
         .first_tile = static_cast<std::uint32_t>(tile_count_),
         .row_bytes = (static_cast<std::uint32_t>(std::min(width, kEdge)) + 1) * texel_bytes_});
    tile_count_ += std::size_t{tiles(width)} * tiles(height);
  }
  tiles_ = std::make_unique<std::atomic<std::byte*>[]>(tile_count_);
}

Texels::~Texels() {
  for (std::size_t i = 0; i < tile_count_; ++i) delete[] tiles_[i].load();
  used_bytes -= held_bytes_;
}

void Texels::set_memory(std::uint64_t bytes) { most_bytes = bytes; }
std::uint64_t Texels::memory_used() { return used_bytes; }

const std::byte* Texels::load(const Level& level, std::size_t tile, int x, int y) const {
  const std::scoped_lock lock(loading_);
  if (const std::byte* there = tiles_[tile].load()) return there;
  const int left = x & -kEdge, top = y & -kEdge;
  const int columns = std::min(kEdge, level.columns - left) + 1;
  const int rows = std::min(kEdge, level.rows - top) + 1;
  const std::size_t bytes = static_cast<std::size_t>(rows) * level.row_bytes;
  if (!take_memory(bytes)) return nullptr;
  try {
    auto texels = std::make_unique<std::byte[]>(bytes);
    read(level, {left, top, columns, rows}, texels.get(), level.row_bytes);
    held_bytes_ += bytes;
    tiles_[tile].store(texels.get(), std::memory_order_release);
    return texels.release();
  } catch (...) {
    used_bytes -= bytes;
    throw;
  }
}

Texels::Square Texels::read_square(const Level& level, int x, int y, Room& room) const {
  const std::size_t row_bytes = std::size_t{2} * texel_bytes_;
  read(level, {x, y, 2, 2}, room.texels.data(), row_bytes);
  return {room.texels.data(), room.texels.data() + row_bytes};
}

void Texels::read(const Level& level, const TexelRectangle& r, std::byte* texels,
                  std::size_t row_bytes) const {
  // What follows the last column, or row.
  const auto next = [&](int count) { return wrap_ == TextureWrap::kRepeat ? 0 : count - 1; };
  const int inside_x = std::min(r.width, level.columns - r.x);
  const int inside_y = std::min(r.height, level.rows - r.y);
  const auto number = static_cast<std::size_t>(&level - levels_.data());
  const auto read_rows = [&](int y, int height, std::byte* to) {
    library_.read(image_, number, {r.x, y, inside_x, height}, to, row_bytes);
    if (inside_x == r.width) return;
    library_.read(image_, number, {next(level.columns), y, 1, height},
                  to + static_cast<std::size_t>(inside_x) * texel_bytes_, row_bytes);
  };
  read_rows(r.y, inside_y, texels);
  if (inside_y == r.height) return;
  read_rows(next(level.rows), 1, texels + static_cast<std::size_t>(inside_y) * row_bytes);
}

template <int kChannels>
std::array<float, kChannels> Texels::interpolated(const Level& level, float s, float t) const {
  // The texel whose centre is left of the place, or above it, and how far the place is from there.
  const auto before = [&](float along, float size, int count) {
    const float place = along * size - 0.5f;
    const float whole = std::floor(place);
    int index = static_cast<int>(whole);
    float part = place - whole;
    if (index < 0) {
      index = wrap_ == TextureWrap::kRepeat ? count - 1 : 0;
      part = wrap_ == TextureWrap::kRepeat ? part : 0.0f;
    }
    return std::pair(index, part);
  };
  const auto [x, right] = before(s, level.width, level.columns);
  const auto [y, down] = before(t, level.height, level.rows);
  Room room;
  const Square found = square(level, x, y, room);
  return image_.half ? mixed<std::uint16_t, kChannels>(found.top, found.bottom, right, down)
                     : mixed<float, kChannels>(found.top, found.bottom, right, down);
}

template <int kChannels>
std::array<float, kChannels> Texels::at(float u, float v, float footprint) const {
  // Texels are counted from the top row down.
  const float s = wrapped(u, wrap_), t = 1.0f - wrapped(v, wrap_);
  // Beyond one picture there is nothing coarser.
  const float width = footprint > 0.0f ? std::min(footprint, 1.0f) : 0.0f;
  // The finest level whose texels are as wide as the footprint: it, and the one before.
  const auto fits = [&](const Level& level) { return width * level.edge <= 1.0f; };
  if (fits(levels_.front())) return interpolated<kChannels>(levels_.front(), s, t);
  const auto coarser = std::ranges::find_if(levels_, fits);
  if (coarser == levels_.end()) return interpolated<kChannels>(levels_.back(), s, t);
  // From half a texel of it, which is one of the finer level, to a whole one.
  const float part = std::max(2.0f * width * coarser->edge - 1.0f, 0.0f);
  auto values = interpolated<kChannels>(*(coarser - 1), s, t);
  const auto coarse = interpolated<kChannels>(*coarser, s, t);
  for (std::size_t c = 0; c < kChannels; ++c) values[c] = between(values[c], coarse[c], part);
  return values;
}

template std::array<float, 1> Texels::at<1>(float, float, float) const;
template std::array<float, 3> Texels::at<3>(float, float, float) const;

}  // namespace nocturne

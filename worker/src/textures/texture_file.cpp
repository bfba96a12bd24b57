#include "textures/texture_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>

#include "files/mapped_file.h"

namespace nocturne {
namespace {

static_assert(std::endian::native == std::endian::little);

using Level = TextureFile::Level;
using Numbers = TextureFile::Numbers;

struct Header {
  std::array<char, 8> magic;
  std::uint32_t version, width, height, channels;
  Numbers finest, coarser;
  std::uint32_t levels;
};
static_assert(sizeof(Header) == 36);

constexpr std::array kMagic{'N', 'O', 'C', 'T', 'E', 'X', 'E', 'L'};
constexpr std::array kOpenExr{'\x76', '\x2f', '\x31', '\x01'};

// As the scene compiler's.
constexpr std::uint32_t kMaxEdge = 16384;
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 26;

constexpr std::size_t kTableSize = 256, kAlignment = 64;
constexpr float kLargest = 1e38f;

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument(what); }

void require(bool condition, const char* what) {
  if (!condition) refuse(what);
}

const Header& checked_header(const MappedFile& file, int channels) {
  const auto starts_with = [&](const auto& magic) {
    return file.size >= magic.size() &&
           std::memcmp(file.bytes.get(), magic.data(), magic.size()) == 0;
  };
  if (starts_with(kOpenExr)) {
    refuse("an OpenEXR file, as former versions wrote textures: compile the scene again");
  }
  require(starts_with(kMagic), "no texture file");
  require(file.size >= sizeof(Header), "a texture file that ends in its header");
  const auto& header = *reinterpret_cast<const Header*>(file.bytes.get());
  if (header.version != TextureFile::kVersion) {
    refuse("a texture file of version " + std::to_string(header.version) + ", where " +
           std::to_string(TextureFile::kVersion) + " is read: compile the scene again");
  }
  require(header.width >= 1 && header.width <= kMaxEdge && header.height >= 1 &&
              header.height <= kMaxEdge &&
              std::uint64_t{header.width} * header.height <= kMaxPixels,
          "a texture file of a size that no texture has");
  require(channels == 1 || channels == 3, "of neither 1 nor 3 channels");
  require(header.channels == static_cast<std::uint32_t>(channels),
          "a texture file of another number of channels than the scene says");
  const auto plain = [](Numbers n) { return n == Numbers::kHalf || n == Numbers::kFloat; };
  require((header.finest == Numbers::kCodes || plain(header.finest)) && plain(header.coarser),
          "a texture file of an unknown kind of numbers");
  require(header.levels ==
              static_cast<std::uint32_t>(std::bit_width(std::max(header.width, header.height))),
          "a texture file without all levels");
  return header;
}

bool sound(float number) { return std::fabs(number) <= kLargest; }
// Of a half number: its largest exponent says that it is not finite.
bool sound(std::uint16_t number) { return (number & 0x7c00u) != 0x7c00u; }

template <class Number>
bool all_sound(const std::byte* bytes, std::size_t count) {
  bool good = true;
  for (const Number number : std::span(reinterpret_cast<const Number*>(bytes), count)) {
    good &= sound(number);
  }
  return good;
}

Level level_of(std::uint32_t width, std::uint32_t height, Numbers numbers, int channels) {
  const std::uint32_t row_bytes = (std::min<std::uint32_t>(width, TextureFile::kStrip) + 1) *
                                  static_cast<std::uint32_t>(channels) *
                                  static_cast<std::uint32_t>(numbers);
  return {.columns = static_cast<int>(width),
          .rows = static_cast<int>(height),
          .width = static_cast<float>(width),
          .height = static_cast<float>(height),
          .edge = static_cast<float>(std::min(width, height)),
          .numbers = numbers,
          .row_bytes = row_bytes,
          .strip_bytes = std::size_t{row_bytes} * (height + 1),
          .texels = nullptr};
}

std::size_t size_of(const Level& level) {
  const int strips = (level.columns + TextureFile::kStrip - 1) / TextureFile::kStrip;
  return static_cast<std::size_t>(strips) * level.strip_bytes;
}

bool all_sound(const Level& level) {
  switch (level.numbers) {
    case Numbers::kCodes:
      return true;
    case Numbers::kHalf:
      return all_sound<std::uint16_t>(level.texels, size_of(level) / 2);
    case Numbers::kFloat:
      return all_sound<float>(level.texels, size_of(level) / 4);
  }
  return false;
}

}  // namespace

TextureFile map_texture(const std::filesystem::path& path, int channels) {
  const MappedFile file = map_file(path);
  const Header& header = checked_header(file, channels);
  TextureFile texture{file.bytes, channels, {}, nullptr};
  std::size_t end = sizeof(Header);
  const bool codes = header.finest == Numbers::kCodes;
  if (codes) {
    texture.table = reinterpret_cast<const float*>(file.bytes.get() + end);
    end += kTableSize * sizeof(float);
  }
  for (std::uint32_t i = 0; i < header.levels; ++i) {
    end = (end + kAlignment - 1) / kAlignment * kAlignment;
    texture.levels.push_back(level_of(std::max(header.width >> i, 1u),
                                      std::max(header.height >> i, 1u),
                                      i == 0 ? header.finest : header.coarser, channels));
    texture.levels.back().texels = file.bytes.get() + end;
    end += size_of(texture.levels.back());
  }
  if (file.size != end) {
    refuse("a texture file of " + std::to_string(file.size) + " bytes, where its header says " +
           std::to_string(end));
  }
  require((!codes || all_sound<float>(file.bytes.get() + sizeof(Header), kTableSize)) &&
              std::ranges::all_of(texture.levels, [](const auto& each) { return all_sound(each); }),
          "a texture file with a number that is not finite, or beyond 1e38");
  expect_scattered_reads(file);
  return texture;
}

}  // namespace nocturne

// The image library: the only file that knows OpenImageIO. A module of its own, as its 200 shared
// libraries take a quarter of a second to load (textures/image_library.h).
#include "textures/image_library.h"

#include <OpenImageIO/imagecache.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace nocturne {
namespace {

float megabytes(std::uint64_t bytes) { return static_cast<float>(bytes) / 1048576.0f; }

OIIO::ImageCache& make_cache() {
  // Workers have threads of their own; reading a tile starts none.
  OIIO::attribute("threads", 1);
  OIIO::attribute("exr_threads", -1);
  OIIO::ImageCache* cache = OIIO::ImageCache::create(false);
  // Nothing is made up for a file that is not as it should be.
  cache->attribute("autotile", 0);
  cache->attribute("automip", 0);
  cache->attribute("accept_untiled", 0);
  // A file is what its name says; no digest of pixels is asked for.
  cache->attribute("deduplicate", 0);
  cache->attribute("failure_retries", 0);
  return *cache;
}

// The process's one cache, made at the first call and never destroyed, as threads may still read.
OIIO::ImageCache& image_cache() {
  static OIIO::ImageCache& cache = make_cache();
  return cache;
}

// As the scene compiler's.
constexpr int kMaxEdge = 16384;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;
// The cache holds whole tiles.
constexpr int kMaxTileEdge = 1024;
// So that no difference of two texels is beyond all numbers.
constexpr float kLargestTexel = 1e38f;

OIIO::ImageCache::ImageHandle* typed(void* handle) {
  return static_cast<OIIO::ImageCache::ImageHandle*>(handle);
}

// The format is given, not guessed: blobs have no extension, and guessing would hand a damaged file
// to every decoder that OpenImageIO was built with.
OIIO::ImageInput* open_exr_reader() { return OIIO::ImageInput::create("openexr").release(); }

[[noreturn]] void refuse_texture(const std::string& what) {
  // What OpenImageIO has to say may name paths and is kept per thread: taken, so that it does not
  // pile up.
  std::string detail = image_cache().geterror();
  std::ranges::replace(detail, '\n', ' ');
  throw TextureError(what + (detail.empty() ? "" : ": " + detail.substr(0, 200)));
}

void require_texture(bool condition, const char* what) {
  if (!condition) refuse_texture(what);
}

void check_spec(const OIIO::ImageSpec& spec, int channels) {
  require_texture(spec.width >= 1 && spec.width <= kMaxEdge && spec.height >= 1 &&
                      spec.height <= kMaxEdge && spec.depth == 1 &&
                      std::int64_t{spec.width} * spec.height <= kMaxPixels,
                  "an image of a size that no texture has");
  require_texture(spec.nchannels == channels,
                  "an image of another number of channels than it says");
  require_texture(spec.format == OIIO::TypeDesc::HALF || spec.format == OIIO::TypeDesc::FLOAT,
                  "an image that is neither of half nor of float numbers");
  require_texture(spec.tile_width > 0 && spec.tile_width <= kMaxTileEdge && spec.tile_height > 0 &&
                      spec.tile_height <= kMaxTileEdge,
                  "an image that is not tiled, or in tiles that are too large");
  require_texture(spec.x == 0 && spec.y == 0 && spec.full_x == 0 && spec.full_y == 0 &&
                      spec.full_width == spec.width && spec.full_height == spec.height,
                  "an image whose pixels are not all of it");
}

std::vector<OpenedImage::Level> levels_of(OIIO::ImageCache& cache,
                                          OIIO::ImageCache::ImageHandle* image,
                                          const OIIO::ImageSpec& finest) {
  constexpr const char* kNotAll = "an image without all MIP levels";
  const auto count = static_cast<int>(
      std::bit_width(static_cast<unsigned>(std::max(finest.width, finest.height))));
  int found = 0;
  cache.get_image_info(image, nullptr, 0, 0, OIIO::ustring("miplevels"), OIIO::TypeInt, &found);
  require_texture(found == count, kNotAll);
  std::vector<OpenedImage::Level> levels;
  for (int i = 0; i < count; ++i) {
    const OIIO::ImageSpec* spec = cache.imagespec(image, nullptr, 0, i);
    const OpenedImage::Level level{std::max(finest.width >> i, 1), std::max(finest.height >> i, 1)};
    require_texture(spec != nullptr && spec->width == level.width && spec->height == level.height &&
                        spec->x == 0 && spec->y == 0,
                    kNotAll);
    levels.push_back(level);
  }
  return levels;
}

std::array<float, 3> coarsest_mean(OIIO::ImageCache& cache, OIIO::ImageCache::ImageHandle* image,
                                   int levels, int channels) {
  std::array<float, 3> mean{};
  require_texture(cache.get_pixels(image, nullptr, 0, levels - 1, 0, 1, 0, 1, 0, 1, 0, channels,
                                   OIIO::TypeDesc::FLOAT, mean.data()),
                  "an image whose coarsest level can't be read");
  for (const float value : mean) {
    require_texture(std::isfinite(value), "an image with a value that is not finite");
  }
  if (channels == 1) mean.fill(mean[0]);
  return mean;
}

OpenedImage open_image(const std::filesystem::path& file, int channels) {
  require_texture(channels == 1 || channels == 3, "a texture of neither 1 nor 3 channels");
  OIIO::ImageCache& cache = image_cache();
  const OIIO::ustring name(file.string());
  // Another file may have had the name.
  cache.invalidate(name);
  auto* image = cache.add_file(name, open_exr_reader) ? cache.get_image_handle(name) : nullptr;
  try {
    const OIIO::ImageSpec* spec =
        image && cache.good(image) ? cache.imagespec(image, nullptr, 0, 0) : nullptr;
    require_texture(spec != nullptr, "a file that is no image");
    check_spec(*spec, channels);
    auto levels = levels_of(cache, image, *spec);
    const auto mean = coarsest_mean(cache, image, static_cast<int>(levels.size()), channels);
    return {image, channels, spec->format == OIIO::TypeDesc::HALF, std::move(levels), mean};
  } catch (const TextureError&) {
    // A good file may come to this place later.
    cache.invalidate(name);
    throw;
  }
}

bool in_range(float texel) { return std::fabs(texel) <= kLargestTexel; }
// Of a half number: its largest exponent says that it is not finite.
bool in_range(std::uint16_t texel) { return (texel & 0x7c00u) != 0x7c00u; }

template <class T>
bool all_in_range(const TexelRectangle& rectangle, int channels, const std::byte* texels,
                  std::size_t row_bytes) {
  bool good = true;
  for (int y = 0; y < rectangle.height; ++y) {
    const T* row = reinterpret_cast<const T*>(texels + static_cast<std::size_t>(y) * row_bytes);
    for (int i = 0; i < rectangle.width * channels; ++i) {
      good = good && in_range(row[i]);
    }
  }
  return good;
}

void read(const OpenedImage& image, std::size_t level, const TexelRectangle& r, std::byte* texels,
          std::size_t row_bytes) {
  const OIIO::TypeDesc format = image.half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT;
  bool good =
      image_cache().get_pixels(typed(image.handle), nullptr, 0, static_cast<int>(level), r.x,
                               r.x + r.width, r.y, r.y + r.height, 0, 1, 0, image.channels, format,
                               texels, OIIO::AutoStride, static_cast<OIIO::stride_t>(row_bytes));
  good = good && (image.half ? all_in_range<std::uint16_t>(r, image.channels, texels, row_bytes)
                             : all_in_range<float>(r, image.channels, texels, row_bytes));
  if (!good) refuse_texture("a texture that can't be read any more, or that is not finite");
}

void set_memory(std::uint64_t bytes) { image_cache().attribute("max_memory_MB", megabytes(bytes)); }

std::uint64_t memory_used() {
  OIIO::imagesize_t bytes = 0;
  image_cache().getattribute("stat:cache_memory_used", OIIO::TypeDesc::INT64, &bytes);
  return bytes;
}

}  // namespace

extern "C" const ImageLibrary* nocturne_image_library() {
  static constexpr ImageLibrary kLibrary{open_image, read, set_memory, memory_used};
  return &kLibrary;
}

}  // namespace nocturne

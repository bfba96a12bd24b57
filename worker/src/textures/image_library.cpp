// The image library: the only file that knows OpenImageIO. A module of its own, as its 200 shared
// libraries take a quarter of a second to load (textures/image_library.h).
#include "textures/image_library.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

namespace nocturne {
namespace {

// The process's one cache.
struct TextureSystem {
  OIIO::ImageCache& cache;
  OIIO::TextureSystem& lookups;
};

float megabytes(std::uint64_t bytes) { return static_cast<float>(bytes) / 1048576.0f; }

TextureSystem make_system() {
  // Workers have threads of their own; reading a tile starts none.
  OIIO::attribute("threads", 1);
  OIIO::attribute("exr_threads", -1);
  OIIO::ImageCache* cache = OIIO::ImageCache::create(false);
  cache->attribute("max_memory_MB", megabytes(kTextureMemoryBytes));
  // Nothing is made up for a file that is not as it should be.
  cache->attribute("autotile", 0);
  cache->attribute("automip", 0);
  cache->attribute("accept_untiled", 0);
  // A file is what its name says; no digest of pixels is asked for.
  cache->attribute("deduplicate", 0);
  cache->attribute("failure_retries", 0);
  OIIO::TextureSystem* lookups = OIIO::TextureSystem::create(false, cache);
  lookups->attribute("gray_to_rgb", 0);
  lookups->attribute("flip_t", 0);
  return {*cache, *lookups};
}

// Made at the first call and never destroyed, as threads may still look up.
const TextureSystem& texture_system() {
  static const TextureSystem system = make_system();
  return system;
}

// As the scene compiler's.
constexpr int kMaxEdge = 16384;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;
// The cache holds whole tiles.
constexpr int kMaxTileEdge = 1024;
// The coarsest level is one texel, so even a damaged file takes no more memory than this.
constexpr std::int64_t kMaxCoarsestPixels = 64;

OIIO::TextureSystem::TextureHandle* typed(void* handle) {
  return static_cast<OIIO::TextureSystem::TextureHandle*>(handle);
}

// The format is given, not guessed: blobs have no extension, and guessing would hand a damaged file
// to every decoder that OpenImageIO was built with.
OIIO::ImageInput* open_exr_reader() { return OIIO::ImageInput::create("openexr").release(); }

[[noreturn]] void refuse_texture(const std::string& what) {
  // What OpenImageIO has to say may name paths and is kept per thread: taken, so that it does not
  // pile up.
  std::string detail = texture_system().cache.geterror();
  detail += texture_system().lookups.geterror();
  std::ranges::replace(detail, '\n', ' ');
  throw TextureError(what + (detail.empty() ? "" : ": " + detail.substr(0, 200)));
}

void require_texture(bool condition, const char* what) {
  if (!condition) refuse_texture(what);
}

bool has_levels(OIIO::ImageCache& cache, OIIO::ImageCache::ImageHandle* image, int expected) {
  int levels = 0;
  cache.get_image_info(image, nullptr, 0, 0, OIIO::ustring("miplevels"), OIIO::TypeInt, &levels);
  return levels == expected;
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

std::array<float, 3> coarsest_mean(OIIO::ImageCache& cache, OIIO::ImageCache::ImageHandle* image,
                                   int levels, int channels) {
  const OIIO::ImageSpec* spec = cache.imagespec(image, nullptr, 0, levels - 1);
  require_texture(spec != nullptr && spec->image_pixels() <= kMaxCoarsestPixels,
                  "an image without its coarsest level");
  std::vector<float> texels(static_cast<std::size_t>(spec->image_pixels()) *
                            static_cast<std::size_t>(channels));
  require_texture(
      cache.get_pixels(image, nullptr, 0, levels - 1, spec->x, spec->x + spec->width, spec->y,
                       spec->y + spec->height, 0, 1, OIIO::TypeDesc::FLOAT, texels.data()),
      "an image whose coarsest level can't be read");
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < texels.size(); ++i) {
    require_texture(std::isfinite(texels[i]), "an image with a value that is not finite");
    sum[i % static_cast<std::size_t>(channels)] += texels[i];
  }
  std::array<float, 3> mean;
  for (std::size_t c = 0; c < 3; ++c) {
    mean[c] =
        static_cast<float>(sum[channels == 1 ? 0 : c] / static_cast<double>(spec->image_pixels()));
  }
  return mean;
}

// To where the picture is, so that no large number meets an integer.
float wrapped(float x, TextureWrap wrap) {
  if (!std::isfinite(x)) return 0.0f;
  return wrap == TextureWrap::kClamp ? std::clamp(x, 0.0f, 1.0f) : x - std::floor(x);
}

OpenedImage open_image(const std::filesystem::path& file, int channels) {
  require_texture(channels == 1 || channels == 3, "a texture of neither 1 nor 3 channels");
  OIIO::ImageCache& cache = texture_system().cache;
  const OIIO::ustring name(file.string());
  // Another file may have had the name.
  cache.invalidate(name);
  auto* image = cache.add_file(name, open_exr_reader) ? cache.get_image_handle(name) : nullptr;
  try {
    const OIIO::ImageSpec* spec =
        image && cache.good(image) ? cache.imagespec(image, nullptr, 0, 0) : nullptr;
    require_texture(spec != nullptr, "a file that is no image");
    check_spec(*spec, channels);
    const auto edge = static_cast<unsigned>(std::max(spec->width, spec->height));
    const auto levels = static_cast<int>(std::bit_width(edge));
    require_texture(has_levels(cache, image, levels), "an image without all MIP levels");
    auto* handle = texture_system().lookups.get_texture_handle(name);
    require_texture(handle != nullptr, "a file that is no image");
    return {handle, coarsest_mean(cache, image, levels, channels)};
  } catch (const TextureError&) {
    // A good file may come to this place later.
    cache.invalidate(name);
    throw;
  }
}

void look_up(void* handle, TextureWrap wrap, float u, float v, float width, int count,
             float* result) {
  OIIO::TextureSystem& lookups = texture_system().lookups;
  // OpenImageIO frees it with the thread.
  thread_local OIIO::TextureSystem::Perthread* const thread = lookups.get_perthread_info();
  OIIO::TextureOpt options;
  options.swrap = options.twrap =
      wrap == TextureWrap::kClamp ? OIIO::TextureOpt::WrapClamp : OIIO::TextureOpt::WrapPeriodic;
  options.mipmode = OIIO::TextureOpt::MipModeTrilinear;
  options.interpmode = OIIO::TextureOpt::InterpBilinear;
  // Beyond one picture there is nothing coarser.
  const float w = width > 0.0f ? std::min(width, 1.0f) : 0.0f;
  // OpenImageIO counts from the top row down.
  bool good = lookups.texture(typed(handle), thread, options, wrapped(u, wrap),
                              1.0f - wrapped(v, wrap), w, 0.0f, 0.0f, w, count, result);
  for (int c = 0; c < count; ++c) good = good && std::isfinite(result[c]);
  if (!good) refuse_texture("a texture that can't be read any more, or that is not finite");
}

void set_memory(std::uint64_t bytes) {
  texture_system().cache.attribute("max_memory_MB", megabytes(bytes));
}

std::uint64_t memory_used() {
  OIIO::imagesize_t bytes = 0;
  texture_system().cache.getattribute("stat:cache_memory_used", OIIO::TypeDesc::INT64, &bytes);
  return bytes;
}

}  // namespace

extern "C" const ImageLibrary* nocturne_image_library() {
  static constexpr ImageLibrary kLibrary{open_image, look_up, set_memory, memory_used};
  return &kLibrary;
}

}  // namespace nocturne

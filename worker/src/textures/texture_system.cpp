#include "textures/texture_system.h"

#include "textures/texture.h"

namespace nocturne {
namespace {

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

}  // namespace

const TextureSystem& texture_system() {
  static const TextureSystem system = make_system();
  return system;
}

void set_texture_memory(std::uint64_t bytes) {
  texture_system().cache.attribute("max_memory_MB", megabytes(bytes));
}

std::uint64_t texture_memory_used() {
  OIIO::imagesize_t bytes = 0;
  texture_system().cache.getattribute("stat:cache_memory_used", OIIO::TypeDesc::INT64, &bytes);
  return bytes;
}

}  // namespace nocturne

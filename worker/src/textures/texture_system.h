// The process's one OpenImageIO cache. Only textures/*.cpp include this.
#pragma once

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>

namespace nocturne {

struct TextureSystem {
  OIIO::ImageCache& cache;
  OIIO::TextureSystem& lookups;
};

/// Made at the first call and never destroyed, as threads may still look up.
const TextureSystem& texture_system();

}  // namespace nocturne

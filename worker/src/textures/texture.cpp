#include "textures/texture.h"

#include <dlfcn.h>

#include <mutex>
#include <string>

#include "textures/image_library.h"
#include "textures/texels.h"

namespace nocturne {
namespace {

std::mutex memory_mutex;
std::uint64_t memory_bytes = kTextureMemoryBytes;
bool is_loaded = false;

// Most of it is for texels as they are looked up. What finds no room there is read out of the image
// library's tiles, each time.
void share_memory(const ImageLibrary& library) {
  const std::uint64_t files = memory_bytes / 4;
  library.set_memory(files);
  Texels::set_memory(memory_bytes - files);
}

const ImageLibrary& load() {
  // Beside the program, which the program's run path says; never closed, as threads may look up.
  void* module = dlopen(kImageLibraryModule, RTLD_NOW | RTLD_LOCAL);
  void* entry = module == nullptr ? nullptr : dlsym(module, "nocturne_image_library");
  if (entry == nullptr) {
    throw TextureError(std::string("the program is not whole: ") + dlerror());
  }
  const ImageLibrary& loaded = *reinterpret_cast<decltype(&nocturne_image_library)>(entry)();
  const std::lock_guard lock(memory_mutex);
  is_loaded = true;
  share_memory(loaded);
  return loaded;
}

const ImageLibrary& library() {
  static const ImageLibrary& loaded = load();
  return loaded;
}

}  // namespace

Texture::Texture(const std::filesystem::path& file, int channels, TextureWrap wrap,
                 TextureFilter filter)
    : texels_(std::make_shared<Texels>(library(), library().open(file, channels), wrap)),
      filter_(filter) {}

int Texture::channels() const { return texels_->channels(); }

float Texture::grey(float u, float v, float width) const {
  return texels_->at<1>(u, v, filtered(width))[0];
}

std::array<float, 3> Texture::rgb(float u, float v, float width) const {
  return texels_->at<3>(u, v, filtered(width));
}

std::array<float, 3> Texture::mean() const { return texels_->mean(); }

void set_texture_memory(std::uint64_t bytes) {
  const std::lock_guard lock(memory_mutex);
  memory_bytes = bytes;
  if (is_loaded) share_memory(library());
}
std::uint64_t texture_memory_used() { return Texels::memory_used() + library().memory_used(); }

}  // namespace nocturne

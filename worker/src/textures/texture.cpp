#include "textures/texture.h"

#include <dlfcn.h>

#include <mutex>
#include <string>

#include "textures/image_library.h"

namespace nocturne {
namespace {

std::mutex memory_mutex;
std::uint64_t memory_bytes = kTextureMemoryBytes;
bool is_loaded = false;

const ImageLibrary& load() {
  // Beside the program, which the program's run path says; never closed, as threads may look up.
  void* module = dlopen(kImageLibraryModule, RTLD_NOW | RTLD_LOCAL);
  void* entry = module == nullptr ? nullptr : dlsym(module, "nocturne_image_library");
  if (entry == nullptr) {
    throw TextureError(std::string("the program is not whole: ") + dlerror());
  }
  const ImageLibrary& loaded = *reinterpret_cast<decltype(&nocturne_image_library)>(entry)();
  const std::lock_guard lock(memory_mutex);
  loaded.set_memory(memory_bytes);
  is_loaded = true;
  return loaded;
}

const ImageLibrary& library() {
  static const ImageLibrary& loaded = load();
  return loaded;
}

}  // namespace

Texture::Texture(const std::filesystem::path& file, int channels, TextureWrap wrap,
                 TextureFilter filter)
    : look_up_(library().look_up), channels_(channels), wrap_(wrap), filter_(filter) {
  const OpenedImage image = library().open(file, channels);
  handle_ = image.handle;
  mean_ = image.mean;
}

float Texture::grey(float u, float v, float width) const {
  float value;
  look_up_(handle_, wrap_, u, v, filtered(width), 1, &value);
  return value;
}

std::array<float, 3> Texture::rgb(float u, float v, float width) const {
  std::array<float, 3> values;
  look_up_(handle_, wrap_, u, v, filtered(width), 3, values.data());
  return values;
}

void set_texture_memory(std::uint64_t bytes) {
  const std::lock_guard lock(memory_mutex);
  memory_bytes = bytes;
  if (is_loaded) library().set_memory(bytes);
}
std::uint64_t texture_memory_used() { return library().memory_used(); }

}  // namespace nocturne

#include "support/texture_files.h"

#include <stdlib.h>

#include <stdexcept>

#include "digest/sha256.h"
// After protobuf's headers, which OpenImageIO's spoil.
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

namespace nocturne::test {

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

std::filesystem::path TextureFiles::write(const Picture& picture, bool texture) {
  const auto path = next_path();
  const std::string written = path.string() + ".exr";
  OIIO::ImageBuf image(
      OIIO::ImageSpec(picture.width, picture.height, picture.channels, OIIO::TypeDesc::FLOAT));
  image.set_pixels(OIIO::ROI(), OIIO::TypeDesc::FLOAT, picture.values.data());
  if (!texture) {
    if (!image.write(written)) throw std::runtime_error(image.geterror());
  } else {
    // As scene/nocturne_scene/textures/image_files.py.
    OIIO::ImageSpec config(OIIO::TypeDesc::FLOAT);
    config.tile_width = config.tile_height = 64;
    config.tile_depth = 1;
    config.attribute("maketx:fileformatname", "openexr");
    config.attribute("maketx:filtername", "box");
    config.attribute("compression", "zip");
    if (!OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, image, written,
                                          config)) {
      throw std::runtime_error(OIIO::geterror());
    }
  }
  std::filesystem::rename(written, path);
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

#include "scene/load_textures.h"

#include "scene/blob_file.h"

namespace nocturne {
namespace {

static_assert(sizeof(SigmoidSpectrum) == 3 * sizeof(float));

Texture load_texture(const v1::Texture& message, const FindBlob& find_blob) {
  const std::string name = blob_name(message.blob());
  try {
    return Texture(find_blob(name), static_cast<int>(message.channels()),
                   message.clamp() ? TextureWrap::kClamp : TextureWrap::kRepeat,
                   message.sharp() ? TextureFilter::kSharp : TextureFilter::kFootprint);
  } catch (const std::invalid_argument& error) {
    refuse("texture " + name + ": " + error.what());
  }
}

TextureUse load_use(const LoadContext& context, const v1::TextureUse& message) {
  require(message.texture() < context.textures.size(), "a texture index out of range");
  return {.texture = context.textures[message.texture()],
          .scale_u = finite(message.scale_u(), "a texture's scale"),
          .scale_v = finite(message.scale_v(), "a texture's scale"),
          .offset_u = finite(message.offset_u(), "a texture's offset"),
          .offset_v = finite(message.offset_v(), "a texture's offset"),
          .gain = finite(message.gain(), "a texture's gain"),
          .bias = finite(message.bias(), "a texture's bias")};
}

}  // namespace

std::vector<Texture> load_textures(const v1::CompiledScene& message, const FindBlob& find_blob) {
  std::vector<Texture> textures;
  for (const auto& texture : message.textures()) {
    textures.push_back(load_texture(texture, find_blob));
  }
  return textures;
}

std::shared_ptr<const RgbSpectra> load_rgb_table(const v1::RgbTable& message,
                                                 const FindBlob& find_blob) {
  const std::size_t n = message.resolution();
  require(n >= RgbSpectra::kMinResolution && n <= RgbSpectra::kMaxResolution,
          "an RGB table of a resolution outside [2, 64]");
  const std::size_t count = 3 * n * n * n;
  BlobFile file(find_blob, message.blob(), "an RGB table");
  require(file.size() == n * sizeof(float) + count * sizeof(SigmoidSpectrum),
          "an RGB table of another length than its resolution says");
  auto scales = file.read<float>(n);
  auto coefficients = file.read<SigmoidSpectrum>(count);
  return checked([&] {
    return std::make_shared<const RgbSpectra>(std::move(scales), std::move(coefficients));
  });
}

TextureUse load_texture_use(const LoadContext& context, const v1::TextureUse& message,
                            int channels) {
  TextureUse use = load_use(context, message);
  require(use.texture.channels() == channels,
          "a texture with another number of channels than its "
          "use needs");
  return use;
}

Scalar load_scalar(const LoadContext& context, const v1::Scalar& message, double least,
                   double most) {
  if (message.has_texture()) {
    return Scalar(load_texture_use(context, message.texture(), 1), static_cast<float>(least),
                  static_cast<float>(most));
  }
  require(message.has_constant(), "a number that is not there");
  require(message.constant() >= least && message.constant() <= most, "a number out of range");
  return Scalar(static_cast<float>(message.constant()));
}

Colour load_colour(const LoadContext& context, const v1::Colour& message, float most) {
  const Spectrum& spectrum = context.spectrum(message.spectrum());
  if (!message.has_texture()) return Colour(spectrum);
  return checked([&] {
    return Colour(spectrum, load_use(context, message.texture()), context.rgb_spectra, most);
  });
}

}  // namespace nocturne

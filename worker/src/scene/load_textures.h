// Textures, and the values that may vary by them.
#pragma once

#include <memory>
#include <vector>

#include "parameters/colour.h"
#include "parameters/scalar.h"
#include "scene/load_context.h"

namespace nocturne {

std::vector<Texture> load_textures(const v1::CompiledScene& message, const FindBlob& find_blob);
std::shared_ptr<const RgbSpectra> load_rgb_table(const v1::RgbTable& message,
                                                 const FindBlob& find_blob);

/// `channels`: that the texture must have.
TextureUse load_texture_use(const LoadContext& context, const v1::TextureUse& message,
                            int channels);
/// In [least, most]: a constant must be, a texture is kept there.
Scalar load_scalar(const LoadContext& context, const v1::Scalar& message, double least,
                   double most);
/// A texture of one channel is kept in [0, most].
Colour load_colour(const LoadContext& context, const v1::Colour& message, float most);

}  // namespace nocturne

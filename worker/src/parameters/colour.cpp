#include "parameters/colour.h"

#include <algorithm>
#include <stdexcept>

namespace nocturne {
namespace {

// Over the visible wavelengths; the spectrum of the colour is smooth.
float mean_of(const SigmoidSpectrum& spectrum) {
  constexpr int kFirst = 380, kStep = 10, kCount = 41;
  float sum = 0.0f;
  for (int i = 0; i < kCount; ++i) sum += spectrum(static_cast<float>(kFirst + i * kStep));
  return sum / kCount;
}

}  // namespace

Colour::Colour(Spectrum spectrum, const TextureUse& use, std::shared_ptr<const RgbSpectra> rgb,
               float most)
    : spectrum_(std::move(spectrum)) {
  const bool coloured = use.texture.channels() == 3;
  if (coloured && !rgb) throw std::invalid_argument("a texture in colour without an RGB table");
  varying_ =
      std::make_shared<const Varying>(Varying{use, coloured ? std::move(rgb) : nullptr, most});
}

bool Colour::dark(const SurfacePoint& point) const {
  if (!varying_) return false;
  const TextureUse& use = varying_->use;
  return varying_->rgb ? std::ranges::max(use.rgb(point)) <= 0.0f : use.grey(point) <= 0.0f;
}

float Colour::mean() const {
  if (!varying_) return spectrum_.mean();
  const auto mean = varying_->use.mean();
  return spectrum_.mean() * (varying_->rgb ? mean_of((*varying_->rgb)(mean))
                                           : std::clamp(mean[0], 0.0f, varying_->most));
}

}  // namespace nocturne

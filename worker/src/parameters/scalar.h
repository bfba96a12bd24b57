// A number that may vary over a surface.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "parameters/texture_use.h"

namespace nocturne {

class Scalar {
 public:
  explicit Scalar(float constant) : constant_(constant) {}
  /// The texture's (first) channel, kept in [least, most].
  Scalar(const TextureUse& use, float least, float most)
      : varying_(std::make_shared<const Varying>(Varying{use, least, most})) {}

  /// Empty where it varies.
  std::optional<float> constant() const {
    return varying_ ? std::nullopt : std::optional(constant_);
  }

  float operator()(const SurfacePoint& point) const {
    return varying_ ? std::clamp(varying_->use.grey(point), varying_->least, varying_->most)
                    : constant_;
  }

 private:
  struct Varying {
    TextureUse use;
    float least, most;
  };

  float constant_ = 0.0f;
  std::shared_ptr<const Varying> varying_;
};

}  // namespace nocturne

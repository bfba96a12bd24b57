// What every part of the loader uses: the message, its files, its spectra and textures, and
// the checks.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "math/vec3.h"
#include "nocturne/v1/scene.pb.h"
#include "scene/scene_error.h"
#include "spectrum/rgb_spectra.h"
#include "spectrum/spectrum.h"
#include "textures/texture.h"

namespace nocturne {

[[noreturn]] inline void refuse(const std::string& what) {
  throw SceneError("compiled scene: " + what);
}

inline void require(bool condition, const char* what) {
  if (!condition) refuse(what);
}

inline float finite(double value, const char* what) {
  const auto narrowed = static_cast<float>(value);
  if (!std::isfinite(narrowed)) refuse(std::string(what) + " is not finite");
  return narrowed;
}

inline Vec3 vector(const v1::Vector& v, const char* what) {
  return {finite(v.x(), what), finite(v.y(), what), finite(v.z(), what)};
}

inline void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw SceneError("the scene was not loaded to its end");
}

/// Runs `make`, whose std::invalid_argument becomes a SceneError.
template <class Make>
auto checked(const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    refuse(error.what());
  }
}

/// Lower-case hexadecimal name of a blob; refuses anything but a SHA-256.
std::string blob_name(const std::string& sha256);

struct LoadContext {
  const v1::CompiledScene& message;
  const FindBlob& find_blob;
  std::stop_token stop;
  std::vector<Spectrum> spectra;
  std::vector<Texture> textures;
  /// Empty where the scene has none.
  std::shared_ptr<const RgbSpectra> rgb_spectra;

  const Spectrum& spectrum(std::uint32_t index) const {
    require(index < spectra.size(), "a spectrum index out of range");
    return spectra[index];
  }
};

}  // namespace nocturne

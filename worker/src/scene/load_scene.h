// From the compiled scene message to the scene that is traced: the one place that reads it.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "nocturne/v1/scene.pb.h"
#include "scene/scene.h"

namespace nocturne {

/// The message is malformed, or of a format that this program doesn't know.
class SceneError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Local, verified file of a blob by lower-case hexadecimal SHA-256; throws std::runtime_error if
/// it can't be had.
using FindBlob = std::function<std::filesystem::path(const std::string& sha256)>;

/// Every index, count and number is checked before memory is taken. Throws SceneError.
std::shared_ptr<const Scene> load_scene(const v1::CompiledScene& message,
                                        const FindBlob& find_blob);

}  // namespace nocturne

// What all readers of the compiled scene share.
#pragma once

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

namespace nocturne {

/// The message is malformed, or of a format that this program doesn't know.
class SceneError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Local, verified file of a blob by lower-case hexadecimal SHA-256; throws std::runtime_error if
/// it can't be had. Files of textures stay as long as the scene, others until the next call.
using FindBlob = std::function<std::filesystem::path(const std::string& sha256)>;

}  // namespace nocturne

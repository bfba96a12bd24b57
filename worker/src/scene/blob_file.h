// A blob that holds numbers as they sit in memory, little endian, one table after another.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/load_context.h"

namespace nocturne {

static_assert(std::endian::native == std::endian::little);

class BlobFile {
 public:
  /// `what` is what messages call it: "a table". Throws SceneError.
  BlobFile(const FindBlob& find_blob, const std::string& sha256, const char* what)
      : path_(find_blob(blob_name(sha256))), what_(what), file_(path_, std::ios::binary) {}

  /// Bytes: to be checked before anything is read, as reading takes memory.
  std::uintmax_t size() const { return std::filesystem::file_size(path_); }

  template <class T>
  std::vector<T> read(std::size_t count) {
    std::vector<T> values(count);
    file_.read(reinterpret_cast<char*>(values.data()),
               static_cast<std::streamsize>(count * sizeof(T)));
    if (!file_) refuse(std::string(what_) + " that can't be read");
    return values;
  }

 private:
  std::filesystem::path path_;
  const char* what_;
  std::ifstream file_;
};

}  // namespace nocturne

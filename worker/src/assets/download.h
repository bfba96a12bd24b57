// A file being downloaded into the cache: it gets its name only when all bytes are there and right.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "digest/sha256.h"

namespace nocturne {

/// Removes its temporary file unless commit() succeeded.
class Download {
 public:
  /// Creates a temporary file in `folder`, which must be on the same file system as the later
  /// target of commit(). Throws AssetUnavailable if that is impossible or the disk has less than
  /// `size_bytes` left.
  Download(const std::filesystem::path& folder, std::string sha256, std::uint64_t size_bytes);
  ~Download();
  Download(const Download&) = delete;
  Download& operator=(const Download&) = delete;

  /// Throws AssetDamaged before it writes more than the announced size, AssetUnavailable if the
  /// disk does not take it.
  void write(std::string_view bytes);

  /// Checks size and digest and gives the file its name, replacing any file there in one step.
  /// Throws AssetDamaged or AssetUnavailable.
  void commit(const std::filesystem::path& target);

  /// Temporary files begin with this.
  static constexpr std::string_view kPrefix = ".fetch-";

 private:
  [[noreturn]] void fail(const std::string& action) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  Sha256 digest_;
  std::string expected_sha256_;
  std::uint64_t expected_bytes_;
  std::uint64_t written_bytes_ = 0;
};

}  // namespace nocturne

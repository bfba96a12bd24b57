// A file's bytes in memory, where nobody can change them any more: not who may write to the disk,
// not the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace nocturne {

/// Gone with the object; a process that has mapped it keeps the mapping.
class SealedFile {
 public:
  /// A copy of a file, if that has at most `max_bytes` and its bytes the digest; null if not.
  /// Throws AssetUnavailable where there is no memory for it.
  static std::shared_ptr<const SealedFile> copy(const std::filesystem::path& file,
                                                const std::string& sha256, std::uint64_t max_bytes);
  ~SealedFile();
  SealedFile(const SealedFile&) = delete;
  SealedFile& operator=(const SealedFile&) = delete;

  /// For whoever opens files by name, in this process, as long as this is there.
  const std::filesystem::path& path() const { return path_; }

 private:
  explicit SealedFile(int descriptor);

  int descriptor_;
  std::filesystem::path path_;
};

}  // namespace nocturne

#include "assets/download.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "assets/errors.h"

namespace nocturne {
namespace {

namespace fs = std::filesystem;

void check_space(const fs::path& folder, std::uint64_t size_bytes) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (error) throw AssetUnavailable("cache " + folder.string() + ": " + error.message());
  if (space.available < size_bytes) {
    throw AssetUnavailable("cache " + folder.string() + ": a file of " +
                           std::to_string(size_bytes) + " bytes does not fit, " +
                           std::to_string(space.available) + " bytes are free");
  }
}

}  // namespace

Download::Download(const fs::path& folder, std::string sha256, std::uint64_t size_bytes)
    : expected_sha256_(std::move(sha256)), expected_bytes_(size_bytes) {
  check_space(folder, size_bytes);
  std::string name = (folder / kPrefix).string() + "XXXXXX";
  descriptor_ = mkostemp(name.data(), O_CLOEXEC);
  path_ = name;
  if (descriptor_ < 0) fail("can't be created");
}

Download::~Download() {
  if (descriptor_ >= 0) {
    close(descriptor_);
    unlink(path_.c_str());
  }
}

void Download::fail(const std::string& action) const {
  const std::string reason = std::generic_category().message(errno);
  throw AssetUnavailable("cache file " + path_.string() + " " + action + ": " + reason);
}

void Download::write(std::string_view bytes) {
  if (bytes.size() > expected_bytes_ - written_bytes_) {
    throw AssetDamaged("asset " + expected_sha256_ + ": more bytes than the announced " +
                       std::to_string(expected_bytes_));
  }
  digest_.update(bytes);
  written_bytes_ += bytes.size();
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("can't be written");
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void Download::commit(const fs::path& target) {
  if (written_bytes_ != expected_bytes_) {
    throw AssetDamaged("asset " + expected_sha256_ + ": " + std::to_string(written_bytes_) +
                       " bytes arrived of " + std::to_string(expected_bytes_));
  }
  if (const std::string actual = digest_.hex(); actual != expected_sha256_) {
    throw AssetDamaged("asset " + expected_sha256_ + ": the bytes that arrived have digest " +
                       actual);
  }
  // No fsync: every process checks the digest of the file before it uses it.
  if (rename(path_.c_str(), target.c_str()) != 0) fail("can't be moved to " + target.string());
  close(descriptor_);
  descriptor_ = -1;
}

}  // namespace nocturne

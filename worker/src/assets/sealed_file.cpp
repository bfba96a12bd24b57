#include "assets/sealed_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "assets/errors.h"
#include "digest/sha256.h"

namespace nocturne {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;

[[noreturn]] void fail(const std::string& sha256) {
  throw AssetUnavailable("no memory for a copy of file " + sha256 + ": " +
                         std::generic_category().message(errno));
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

/// Empty at the end; nothing where it can't be read.
std::optional<std::string_view> read_piece(int from, std::vector<char>& buffer) {
  ssize_t count;
  do {
    count = read(from, buffer.data(), buffer.size());
  } while (count < 0 && errno == EINTR);
  if (count < 0) return std::nullopt;
  return std::string_view{buffer.data(), static_cast<std::size_t>(count)};
}

void write_all(int to, std::string_view bytes, const std::string& sha256) {
  while (!bytes.empty()) {
    const ssize_t count = write(to, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(sha256);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace

SealedFile::SealedFile(int descriptor)
    : descriptor_(descriptor), path_("/proc/self/fd/" + std::to_string(descriptor)) {}

SealedFile::~SealedFile() { close(descriptor_); }

std::shared_ptr<const SealedFile> SealedFile::copy(const std::filesystem::path& file,
                                                   const std::string& sha256,
                                                   std::uint64_t max_bytes) {
  const Descriptor from(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat found;
  if (from.number() < 0 || fstat(from.number(), &found) != 0 || !S_ISREG(found.st_mode)) {
    return nullptr;
  }
  Descriptor to(memfd_create(sha256.c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (to.number() < 0) fail(sha256);
  std::vector<char> buffer(kPiece);
  Sha256 digest;
  std::uint64_t bytes = 0;
  while (true) {
    // Another process may write to it at this moment: only the bytes that were read count.
    const auto piece = read_piece(from.number(), buffer);
    if (!piece) return nullptr;
    if (piece->empty()) break;
    bytes += piece->size();
    if (bytes > max_bytes) return nullptr;
    digest.update(*piece);
    write_all(to.number(), *piece, sha256);
  }
  if (digest.hex() != sha256) return nullptr;
  constexpr int kSeals = F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE;
  if (fcntl(to.number(), F_ADD_SEALS, kSeals) != 0) fail(sha256);
  return std::shared_ptr<const SealedFile>(new SealedFile(to.release()));
}

}  // namespace nocturne

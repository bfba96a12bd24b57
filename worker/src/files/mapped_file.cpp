#include "files/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <stdexcept>

namespace nocturne {

MappedFile map_file(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw std::invalid_argument("cannot read " + file.string());
  // The mapping stays when the descriptor is closed.
  const std::unique_ptr<const int, void (*)(const int*)> closing(&descriptor,
                                                                 [](const int* d) { close(*d); });
  struct stat found;
  if (fstat(descriptor, &found) != 0 || !S_ISREG(found.st_mode)) {
    throw std::invalid_argument("cannot read " + file.string());
  }
  const auto size = static_cast<std::size_t>(found.st_size);
  if (size == 0) return {};
  void* bytes = mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor, 0);
  if (bytes == MAP_FAILED) throw std::bad_alloc();
  const auto unmap = [size](std::byte* mapped) { munmap(mapped, size); };
  return {std::shared_ptr<const std::byte>(static_cast<std::byte*>(bytes), unmap), size};
}

void expect_scattered_reads(const MappedFile& file) {
  // A hint: it does not matter whether it is taken.
  madvise(const_cast<std::byte*>(file.bytes.get()), file.size, MADV_RANDOM);
}

}  // namespace nocturne

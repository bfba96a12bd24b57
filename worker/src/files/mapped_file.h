// Files as memory: the kernel reads a page when it is looked at, shares it between processes, and
// may drop it again where memory is short.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

namespace nocturne {

struct MappedFile {
  std::shared_ptr<const std::byte> bytes;
  std::size_t size = 0;
};

/// Read only. The file may be removed or replaced under its name while it is mapped, but nobody may
/// write into it or cut it: to look at a page that is not there any more ends the process. Throws
/// std::invalid_argument if there is no such file.
MappedFile map_file(const std::filesystem::path& file);

/// From now on the kernel reads pages alone, not their surroundings: megabytes for each, where
/// memory is too small for the file.
void expect_scattered_reads(const MappedFile& file);

}  // namespace nocturne

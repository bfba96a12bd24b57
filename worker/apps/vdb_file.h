// OpenVDB files, opened with care: their own metadata is checked before a tree is built.
#pragma once

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace nocturne {

struct GridLimits {
  std::int64_t voxels = 500'000'000;
  std::int64_t bytes = std::int64_t{8} << 30;
};

/// A separate archive class rather than OpenVDB's File, which takes bytes beyond the end of a file
/// for zeros.
class VdbFile : private openvdb::io::Archive {
 public:
  /// Throws std::runtime_error, in words, where it can't be read.
  VdbFile(const std::filesystem::path& path, const GridLimits& limits);

  /// Names, unique in the file.
  std::vector<std::string> names() const;
  /// With all its values. Throws std::runtime_error where there is no such grid, where it says that
  /// it is larger than the limits, or where it is damaged.
  openvdb::GridBase::Ptr read(const std::string& name);

 private:
  using Descriptor = openvdb::io::GridDescriptor;
  struct Entry {
    Descriptor descriptor;
    // Without values; of the right type.
    openvdb::GridBase::Ptr empty;
  };

  const Entry& entry(const std::string& name, const std::string& at) const;
  void check_limits(const Entry& entry, const std::string& at);
  openvdb::GridBase::Ptr read_values(const Entry& entry);

  std::string path_;
  GridLimits limits_;
  std::ifstream in_;
  std::vector<Entry> entries_;
};

/// Type, boxes (of active voxels, both ends part of them; in space to the outer faces), rows of the
/// 3 x 4 matrix from voxels to space, extremes of active values.
nlohmann::json description(const openvdb::GridBase& grid);

}  // namespace nocturne

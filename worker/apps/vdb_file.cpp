#include "vdb_file.h"

#include <openvdb/tools/Count.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

namespace nocturne {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

// A number that OpenVDB writes next to a grid; 0 where it is not there.
std::int64_t said(const openvdb::MetaMap& header, const char* name) {
  const auto number = header.getMetadata<openvdb::Int64Metadata>(name);
  return number ? number->value() : 0;
}

std::string quoted(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "\"" : ", \"") + name + "\"";
  return all.empty() ? "none" : all;
}

template <class T>
json triple(const T& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace

VdbFile::VdbFile(const std::filesystem::path& path, const GridLimits& limits)
    : path_(path.string()), limits_(limits), in_(path, std::ios::binary) {
  if (!std::filesystem::is_regular_file(path)) refuse(path_ + ": there is no such file");
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path));
  constexpr std::int32_t kMaxGrids = 1000;
  try {
    readHeader(in_);
    setFormatVersion(in_);
    setLibraryVersion(in_);
    setDataCompression(in_);
    if (!inputHasGridOffsets())
      refuse("it was written as a stream, and does not say where grids are");
    openvdb::MetaMap().readMeta(in_);
    const std::int32_t count = readGridCount(in_);
    if (count < 0 || count > kMaxGrids) refuse(std::to_string(count) + " grids");
    for (std::int32_t i = 0; i < count; ++i) {
      Descriptor descriptor;
      auto empty = descriptor.read(in_);
      // Positions first: reading beyond the end gives zeros without a word.
      if (descriptor.getGridPos() < 0 || descriptor.getGridPos() > descriptor.getEndPos() ||
          descriptor.getEndPos() > size) {
        refuse("the file ends too early");
      }
      entries_.push_back({descriptor, std::move(empty)});
      descriptor.seekToEnd(in_);
    }
    if (!in_) refuse("the file ends too early");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    refuse(path_ + ": not an OpenVDB file, or a damaged one: " + error.what());
  }
}

std::vector<std::string> VdbFile::names() const {
  std::vector<std::string> all;
  for (const auto& [descriptor, empty] : entries_) {
    all.push_back(Descriptor::nameAsString(descriptor.uniqueName()));
  }
  return all;
}

openvdb::GridBase::Ptr VdbFile::read(const std::string& name) {
  const std::string at = path_ + ": grid \"" + name + "\"";
  const Entry& found = entry(name, at);
  try {
    check_limits(found, at);
    auto grid = read_values(found);
    if (found.descriptor.isInstance()) {
      // Shares the tree of another, of the same type or it would not be one.
      const std::string other = Descriptor::nameAsString(found.descriptor.instanceParentName());
      const Entry& parent = entry(other, at + ", an instance,");
      if (parent.descriptor.isInstance()) refuse(at + " is an instance of an instance");
      check_limits(parent, at);
      grid->setTree(read_values(parent)->baseTreePtr());
    }
    if (!grid->transform().isLinear()) refuse(at + " has a transform that is not affine");
    return grid;
  } catch (const openvdb::Exception& error) {
    refuse(at + " is damaged: " + error.what());
  }
}

const VdbFile::Entry& VdbFile::entry(const std::string& name, const std::string& at) const {
  const auto all = names();
  const auto found = std::ranges::find(all, name);
  if (found == all.end()) refuse(at + " is not there; there are: " + quoted(all));
  return entries_[static_cast<std::size_t>(found - all.begin())];
}

// By what its header says, before anything of the tree is read.
void VdbFile::check_limits(const Entry& entry, const std::string& at) {
  openvdb::MetaMap header;
  entry.descriptor.seekToGrid(in_);
  readGridCompression(in_);
  header.readMeta(in_);
  const std::int64_t voxels = said(header, openvdb::GridBase::META_FILE_VOXEL_COUNT);
  const std::int64_t bytes = said(header, openvdb::GridBase::META_FILE_MEM_BYTES);
  if (voxels < 0 || voxels > limits_.voxels) {
    refuse(at + " says that it has " + std::to_string(voxels) + " voxels; at most " +
           std::to_string(limits_.voxels) + " are read (--max-voxels)");
  }
  if (bytes < 0 || bytes > limits_.bytes) {
    refuse(at + " says that it takes " + std::to_string(bytes) + " bytes; at most " +
           std::to_string(limits_.bytes) + " are read (--max-bytes)");
  }
}

openvdb::GridBase::Ptr VdbFile::read_values(const Entry& entry) {
  auto grid = entry.empty->copyGridWithNewTree();
  entry.descriptor.seekToGrid(in_);
  readGrid(grid, entry.descriptor, in_);
  if (!in_) OPENVDB_THROW(openvdb::IoError, "the file ends too early");
  return grid;
}

json description(const openvdb::GridBase& grid) {
  const openvdb::math::Mat4d m = grid.transform().baseMap()->getAffineMap()->getMat4();
  json transform = json::array();
  // OpenVDB multiplies rows by matrices.
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) transform.push_back(m(column, row));
  }
  json all = {{"name", grid.getName()},
              {"type", grid.valueType()},
              {"class", openvdb::GridBase::gridClassToString(grid.getGridClass())},
              {"voxels", grid.activeVoxelCount()},
              {"transform", transform}};
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (!box.empty()) {
    all["index_box"] = {triple(box.min()), triple(box.max())};
    const openvdb::BBoxd faces(box.min().asVec3d() - 0.5, box.max().asVec3d() + 0.5);
    const openvdb::BBoxd world = faces.applyMap(*grid.transform().baseMap());
    all["world_box"] = {triple(world.min()), triple(world.max())};
  }
  if (const auto* floats = dynamic_cast<const openvdb::FloatGrid*>(&grid)) {
    all["background"] = floats->background();
    if (!box.empty()) {
      const auto extremes = openvdb::tools::minMax(floats->tree());
      all["least"] = extremes.min();
      all["most"] = extremes.max();
    }
  }
  return all;
}

}  // namespace nocturne

#include "grid_commands.h"

#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <span>
#include <stdexcept>
#include <utility>

#include "media/float_grid.h"

namespace nocturne {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

// Whole or not at all: written next to it, then renamed.
void write_file(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path part = path.string() + ".part";
  try {
    write(part);
    fs::rename(part, path);
  } catch (...) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw;
  }
}

template <class T>
T field(const json& from, const char* name, const std::string& at) {
  if (!from.contains(name)) refuse(at + ": \"" + name + "\" is missing");
  try {
    return from.at(name).get<T>();
  } catch (const json::exception&) {
    refuse(at + ": \"" + name + "\" is not of the right type");
  }
}

json parsed(const fs::path& path) {
  std::ifstream file(path);
  if (!file) refuse(path.string() + ": can't be read");
  try {
    return json::parse(file);
  } catch (const json::exception& error) {
    refuse(path.string() + ": " + error.what());
  }
}

void only(const json& object, std::initializer_list<const char*> names, const std::string& at) {
  if (!object.is_object()) refuse(at + ": not an object");
  for (const auto& [key, value] : object.items()) {
    if (std::ranges::find(names, key) == names.end()) refuse(at + ": \"" + key + "\" is not known");
  }
}

std::vector<float> read_values(const fs::path& path, std::size_t count) {
  std::ifstream file(path, std::ios::binary);
  std::error_code none;
  const std::uintmax_t size = fs::file_size(path, none);
  if (!file || none) refuse(path.string() + ": can't be read");
  if (size != count * sizeof(float)) {
    refuse(path.string() + ": has " + std::to_string(size) + " bytes, not the " +
           std::to_string(count * sizeof(float)) + " of its dims");
  }
  std::vector<float> values(count);
  file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(size));
  if (!file) refuse(path.string() + ": can't be read");
  const auto bad =
      std::ranges::find_if_not(values, [](float x) { return std::isfinite(x) && x >= 0.0f; });
  if (bad != values.end()) {
    refuse(path.string() + ": value " + std::to_string(bad - values.begin()) + " is " +
           std::to_string(*bad) + "; values are finite and not negative");
  }
  return values;
}

// Voxels of a grid where it may have other values than its background.
struct Extent {
  std::array<std::int64_t, 3> first, dims;
  std::size_t voxels = 1;
};

Extent extent(const FloatGrid& grid, const std::string& at, const GridLimits& limits) {
  Extent all{grid.box().low, {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all.dims[axis] = grid.box().high[axis] - all.first[axis] + 1;
    if (all.dims[axis] > limits.voxels / static_cast<std::int64_t>(all.voxels)) {
      refuse(at + ": its values fill a box of more than " + std::to_string(limits.voxels) +
             " voxels (--max-voxels)");
    }
    all.voxels *= static_cast<std::size_t>(all.dims[axis]);
  }
  return all;
}

std::vector<float> dense_values(const FloatGrid& grid, const Extent& extent) {
  std::vector<float> values(extent.voxels, grid.background());
  grid.for_each_block([&](const FloatGrid::Block& block) {
    if (block.values == nullptr && block.value == grid.background()) return;
    const auto offset = [&](std::size_t axis) { return block.origin[axis] - extent.first[axis]; };
    for (std::int64_t x = 0; x < block.size; ++x) {
      for (std::int64_t y = 0; y < block.size; ++y) {
        const std::int64_t row = (offset(0) + x) * extent.dims[1] + offset(1) + y;
        const auto to = values.begin() + row * extent.dims[2] + offset(2);
        if (block.values == nullptr) {
          std::fill_n(to, block.size, block.value);
        } else {
          std::copy_n(block.values + (x << 6 | y << 3), block.size, to);
        }
      }
    }
  });
  return values;
}

// What all grids of a file share.
struct Layout {
  std::array<std::int64_t, 3> dims;
  openvdb::math::Transform::Ptr transform;
};

Layout layout(const json& input, const std::string& at, const GridLimits& limits) {
  Layout all{field<std::array<std::int64_t, 3>>(input, "dims", at), nullptr};
  std::int64_t voxels = 1;
  for (const std::int64_t n : all.dims) {
    if (n < 1 || n > limits.voxels / voxels) {
      refuse(at + ": \"dims\" are at least 1, and make at most " + std::to_string(limits.voxels) +
             " voxels (--max-voxels)");
    }
    voxels *= n;
  }
  const auto size = field<double>(input, "voxel_size", at);
  if (!(size > 0.0) || !std::isfinite(size)) refuse(at + ": \"voxel_size\" is not positive");
  const auto origin = input.contains("origin") ? field<std::array<double, 3>>(input, "origin", at)
                                               : std::array<double, 3>{};
  all.transform = openvdb::math::Transform::createLinearTransform(size);
  all.transform->postTranslate(openvdb::Vec3d(origin[0], origin[1], origin[2]));
  return all;
}

openvdb::FloatGrid::Ptr grid_of(const json& entry, const Layout& layout, const fs::path& folder,
                                const std::string& at) {
  only(entry, {"name", "file", "tolerance", "background", "half"}, at);
  const auto tolerance = entry.contains("tolerance") ? field<float>(entry, "tolerance", at) : 0.0f;
  const auto background =
      entry.contains("background") ? field<float>(entry, "background", at) : 0.0f;
  if (!(tolerance >= 0.0f) || !(background >= 0.0f) || !std::isfinite(background)) {
    refuse(at + ": \"tolerance\" and \"background\" are not negative");
  }
  const auto& n = layout.dims;
  auto values = read_values(folder / field<std::string>(entry, "file", at),
                            static_cast<std::size_t>(n[0] * n[1] * n[2]));
  const auto last = [&](std::size_t axis) { return static_cast<int>(n[axis] - 1); };
  const openvdb::CoordBBox box({0, 0, 0}, {last(0), last(1), last(2)});
  const openvdb::tools::Dense<float, openvdb::tools::LayoutZYX> dense(box, values.data());
  auto grid = openvdb::FloatGrid::create(background);
  grid->setName(field<std::string>(entry, "name", at));
  grid->setTransform(layout.transform);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setSaveFloatAsHalf(entry.contains("half") && field<bool>(entry, "half", at));
  openvdb::tools::copyFromDense(dense, *grid, tolerance);
  return grid;
}

}  // namespace

json inspect_grids(const fs::path& vdb, const GridLimits& limits) {
  VdbFile file(vdb, limits);
  json grids = json::array();
  for (const std::string& name : file.names()) grids.push_back(description(*file.read(name)));
  return {{"file_bytes", fs::file_size(vdb)}, {"grids", grids}};
}

json convert_grid(const fs::path& vdb, const std::string& name, const fs::path& output,
                  const GridLimits& limits) {
  const std::string at = vdb.string() + ": grid \"" + name + "\"";
  auto base = VdbFile(vdb, limits).read(name);
  auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(base);
  if (!grid) refuse(at + " has values of type " + base->valueType() + ", not float");
  base.reset();
  if (grid->activeVoxelCount() == 0) refuse(at + " is empty");
  json written = description(*grid);
  auto handle = nanovdb::openToNanoVDB(*grid);
  grid.reset();
  write_file(output, [&](const fs::path& part) {
    std::ofstream out(part, std::ios::binary);
    out.write(reinterpret_cast<const char*>(handle.data()),
              static_cast<std::streamsize>(handle.size()));
    out.close();
    if (!out) refuse(output.string() + ": can't be written");
    handle.reset();
    try {
      // As the worker will read it.
      const FloatGrid checked = FloatGrid::map(part);
      written["most"] = checked.majorant();
      written["bytes"] = checked.size();
    } catch (const std::invalid_argument& error) {
      refuse(at + ": " + error.what());
    }
  });
  return written;
}

json grid_values(const fs::path& nvdb, const fs::path& output, const GridLimits& limits) {
  const FloatGrid grid = [&] {
    try {
      return FloatGrid::map(nvdb);
    } catch (const std::invalid_argument& error) {
      refuse(nvdb.string() + ": " + error.what());
    }
  }();
  const Extent all = extent(grid, nvdb.string(), limits);
  const std::vector<float> values = dense_values(grid, all);
  write_file(output, [&](const fs::path& part) {
    std::ofstream out(part, std::ios::binary);
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(float)));
    out.close();
    if (!out) refuse(output.string() + ": can't be written");
  });
  const Matrix3& m = grid.matrix();
  const Double3 shift = grid.shift();
  return {
      {"dims", all.dims},
      {"first_voxel", all.first},
      {"background", grid.background()},
      {"transform",
       {m.x.x, m.x.y, m.x.z, shift.x, m.y.x, m.y.y, m.y.z, shift.y, m.z.x, m.z.y, m.z.z, shift.z}}};
}

json create_grids(const fs::path& input, const fs::path& output, const GridLimits& limits) {
  const json all = parsed(input);
  const std::string at = input.string();
  only(all, {"dims", "voxel_size", "origin", "grids"}, at);
  const Layout shared = layout(all, at, limits);
  const auto entries = field<std::vector<json>>(all, "grids", at);
  if (entries.empty()) refuse(at + ": \"grids\" is empty");
  openvdb::GridCPtrVec grids;
  json written = json::array();
  for (const json& entry : entries) {
    const auto grid = grid_of(entry, shared, input.parent_path(),
                              at + ": grids[" + std::to_string(grids.size()) + "]");
    grids.push_back(grid);
    written.push_back(description(*grid));
  }
  write_file(output, [&](const fs::path& part) {
    openvdb::io::File file(part.string());
    file.write(grids);
    file.close();
  });
  return {{"file_bytes", fs::file_size(output)}, {"grids", written}};
}

}  // namespace nocturne

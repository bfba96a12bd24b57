#include "grid_bytes.h"

#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/SampleFromVoxels.h>

#include <cstring>
#include <memory>

namespace nocturne::test {

std::vector<std::byte> grid_bytes(const VoxelValue& value, std::array<int, 3> low,
                                  std::array<int, 3> high, float background,
                                  const std::array<double, 12>& m) {
  nanovdb::GridBuilder<float> builder(background, nanovdb::GridClass::FogVolume);
  builder([&](const nanovdb::Coord& at) { return value(at.x(), at.y(), at.z()); },
          nanovdb::CoordBBox(nanovdb::Coord(low[0], low[1], low[2]),
                             nanovdb::Coord(high[0], high[1], high[2])));
  nanovdb::Map map{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      map.mMatD[3 * row + column] = m[4 * row + column];
    }
    map.mVecD[row] = m[4 * row + 3];
  }
  const auto handle = builder.getHandle<>(map, "density");
  std::vector<std::byte> bytes(handle.size());
  std::memcpy(bytes.data(), handle.data(), bytes.size());
  return bytes;
}

Sampler sampler(const std::vector<std::byte>& grid, bool nearest) {
  // A copy with NanoVDB's alignment.
  auto buffer = nanovdb::HostBuffer::create(grid.size());
  std::memcpy(buffer.data(), grid.data(), grid.size());
  const auto handle = std::make_shared<const nanovdb::GridHandle<>>(std::move(buffer));
  return [handle, nearest](double x, double y, double z) {
    const auto accessor = handle->grid<float>()->getAccessor();
    const nanovdb::Vec3d at(x, y, z);
    return static_cast<double>(
        nearest ? nanovdb::createSampler<0, decltype(accessor), false>(accessor)(at)
                : nanovdb::createSampler<1, decltype(accessor), false>(accessor)(at));
  };
}

}  // namespace nocturne::test

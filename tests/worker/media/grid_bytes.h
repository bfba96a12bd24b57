// Grids for tests, laid out by NanoVDB's own builder.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace nocturne::test {

using VoxelValue = std::function<float(int, int, int)>;

/// `value` from voxel `low` to voxel `high`, both part of it, and `background` elsewhere; blocks of
/// one value become tiles. `transform`: rows of the 3 x 4 matrix from voxels to the grid's space.
std::vector<std::byte> grid_bytes(const VoxelValue& value, std::array<int, 3> low,
                                  std::array<int, 3> high, float background = 0.0f,
                                  const std::array<double, 12>& transform = {1, 0, 0, 0, 0, 1, 0, 0,
                                                                             0, 0, 1, 0});

/// NanoVDB's own samplers, by voxel coordinates: linear, or of the nearest voxel.
using Sampler = std::function<double(double x, double y, double z)>;
Sampler sampler(const std::vector<std::byte>& grid, bool nearest);

}  // namespace nocturne::test

// A sparse grid of float values as NanoVDB lays it out, checked before it is used: Museth,
// "NanoVDB: A GPU-Friendly and Portable VDB Data Structure For Real-Time Rendering And Simulation",
// SIGGRAPH 2021 Talks. The tree has blocks of 8^3 voxels, and nodes of 16^3 blocks and 32^3 such
// nodes, each of which may be one value.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "math/double3.h"

namespace nocturne {

class FloatGrid {
 public:
  static constexpr std::uintmax_t kMaxBytes = std::uintmax_t{8} << 30;

  /// Where voxels may have other values than the background; both ends are part of it.
  struct Box {
    std::array<std::int64_t, 3> low, high;
  };
  /// A cube of `size` voxels a side, first of them `origin`. `values`: 8^3 of them, z fastest; null
  /// where all are `value`.
  struct Block {
    std::array<std::int64_t, 3> origin;
    std::int64_t size;
    const float* values;
    float value;
  };

  /// Of a whole file, whose pages all processes share; or of a copy of bytes. Only for a grid of
  /// floats whose header says the size that is there. All values are finite and not negative, and
  /// not all of them the background. Throws std::invalid_argument for anything else, in words.
  /// Nothing is checked again where a page is read later (files/mapped_file.h).
  static FloatGrid map(const std::filesystem::path& file);
  explicit FloatGrid(std::span<const std::byte> bytes);

  float value(int x, int y, int z) const;
  /// The eight from (x, y, z) to (x + 1, y + 1, z + 1), z fastest.
  std::array<float, 8> corners(int x, int y, int z) const;

  const Box& box() const { return box_; }
  float background() const { return background_; }
  float majorant() const { return majorant_; }
  /// From voxels to the grid's own space: matrix x index + shift.
  const Matrix3& matrix() const { return matrix_; }
  Double3 shift() const { return shift_; }
  std::size_t size() const { return size_; }

  void for_each_block(const std::function<void(const Block&)>& f) const;

 private:
  using Bytes = std::shared_ptr<const std::byte>;

  FloatGrid(Bytes bytes, std::size_t size);
  void check();

  Bytes bytes_;
  std::size_t size_;
  Box box_;
  float background_ = 0.0f, majorant_ = 0.0f;
  Matrix3 matrix_;
  Double3 shift_;
};

}  // namespace nocturne

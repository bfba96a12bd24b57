#include "media/float_grid.h"

#include <nanovdb/NanoVDB.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "files/mapped_file.h"

namespace nocturne {
namespace {

using Grid = nanovdb::GridData;
using Tree = nanovdb::TreeData<3>;
using Root = nanovdb::NanoRoot<float>::DataType;
using Upper = nanovdb::NanoUpper<float>::DataType;
using Lower = nanovdb::NanoLower<float>::DataType;
using Leaf = nanovdb::NanoLeaf<float>::DataType;

// Lookups search them one after another.
constexpr std::uint32_t kMaxRootTiles = 4096;

// So that no index of a neighbour overflows.
constexpr std::int64_t kFarthest = std::int64_t{1} << 30;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("a density grid " + what);
}

bool sound(float value) { return value >= 0.0f && value <= FLT_MAX; }

template <class T>
const T* at(const std::byte* bytes, std::uint64_t offset) {
  return reinterpret_cast<const T*>(bytes + offset);
}

const Root& root_of(const std::byte* bytes) {
  return *at<Root>(bytes, sizeof(Grid) + at<Tree>(bytes, sizeof(Grid))->mNodeOffset[3]);
}

template <class Child, class Node>
const Child& child(const Node& node, std::uint32_t slot) {
  return *at<Child>(reinterpret_cast<const std::byte*>(&node),
                    static_cast<std::uint64_t>(node.mTable[slot].child));
}
const Upper& child(const Root& root, std::uint32_t tile) {
  return *at<Upper>(reinterpret_cast<const std::byte*>(&root),
                    static_cast<std::uint64_t>(root.tile(tile)->child));
}

// Of a node with 2^log2 slots a side: where slot number n is.
template <std::uint32_t kLog2>
std::array<std::int64_t, 3> slot(std::array<std::int64_t, 3> origin, std::uint32_t n,
                                 std::int64_t size) {
  constexpr std::uint32_t kMask = (1u << kLog2) - 1u;
  return {origin[0] + size * (n >> 2 * kLog2), origin[1] + size * (n >> kLog2 & kMask),
          origin[2] + size * (n & kMask)};
}

constexpr std::uint32_t kUpperSlots = 1u << 15, kLowerSlots = 1u << 12;

void check_header(const Grid& grid, std::uintmax_t size) {
  if (grid.mMagic != NANOVDB_MAGIC_NUMBER) refuse("that is no NanoVDB buffer");
  if (grid.mVersion.getMajor() != NANOVDB_MAJOR_VERSION_NUMBER) {
    refuse("of NanoVDB version " + std::to_string(grid.mVersion.getMajor()) + ", where " +
           std::to_string(NANOVDB_MAJOR_VERSION_NUMBER) + " is read");
  }
  if (grid.mGridType != nanovdb::GridType::Float) refuse("whose values are not of type float");
  if (grid.mGridSize != size) {
    refuse("of " + std::to_string(size) + " bytes, where its header says " +
           std::to_string(grid.mGridSize));
  }
}

void check_size(std::uintmax_t size) {
  if (size < sizeof(Grid) + sizeof(Tree) + sizeof(Root)) refuse("that is too short");
  if (size > FloatGrid::kMaxBytes) refuse("that is larger than 8 GiB");
}

// The nodes of one level: all in a row, each with one parent.
class Level {
 public:
  Level(const std::byte* bytes, std::size_t size, const Tree& tree, std::size_t level,
        std::size_t node_size)
      : bytes_(bytes), node_size_(node_size), seen_(checked_count(size, tree, level)) {
    first_ = sizeof(Grid) + tree.mNodeOffset[level];
  }

  // Throws unless there is such a node which nobody had as a child before.
  void take(const void* parent, std::int64_t offset) {
    const auto from = static_cast<std::uint64_t>(static_cast<const std::byte*>(parent) - bytes_);
    // Wraps around where the offset is nonsense, and is then too large.
    const std::uint64_t way = from + static_cast<std::uint64_t>(offset) - first_;
    const std::uint64_t index = way / node_size_;
    if (way % node_size_ != 0 || index >= seen_.size()) refuse("with a node outside of its place");
    if (seen_[index]) refuse("with a node that has two parents");
    seen_[index] = true;
  }

 private:
  std::size_t checked_count(std::size_t size, const Tree& tree, std::size_t level) const {
    const std::size_t count = tree.mNodeCount[level];
    const std::uint64_t offset = tree.mNodeOffset[level];
    const std::size_t room = size - sizeof(Grid);
    if (count > 0 && (offset % 32 != 0 || offset > room || count > (room - offset) / node_size_)) {
      refuse("with nodes outside of its bytes");
    }
    return count;
  }

  const std::byte* bytes_;
  std::size_t node_size_;
  std::uint64_t first_ = 0;
  std::vector<bool> seen_;
};

void check_nodes(const std::byte* bytes, std::size_t size) {
  const Tree& tree = *at<Tree>(bytes, sizeof(Grid));
  const std::uint64_t offset = tree.mNodeOffset[3];
  const std::size_t room = size - sizeof(Grid) - sizeof(Root);
  if (offset % 32 != 0 || offset < sizeof(Tree) || offset > room) {
    refuse("with a root outside of its bytes");
  }
  const Root& root = root_of(bytes);
  if (root.mTableSize > kMaxRootTiles) {
    refuse("with more than " + std::to_string(kMaxRootTiles) + " nodes at its root");
  }
  if (root.mTableSize > (room - offset) / sizeof(Root::Tile)) {
    refuse("with a root that is longer than its bytes");
  }
  Level uppers(bytes, size, tree, 2, sizeof(Upper));
  Level lowers(bytes, size, tree, 1, sizeof(Lower));
  Level leaves(bytes, size, tree, 0, sizeof(Leaf));
  for (std::uint32_t t = 0; t < root.mTableSize; ++t) {
    if (!root.tile(t)->isChild()) continue;
    uppers.take(&root, root.tile(t)->child);
    const Upper& upper = child(root, t);
    for (std::uint32_t u = 0; u < kUpperSlots; ++u) {
      if (!upper.mChildMask.isOn(u)) continue;
      lowers.take(&upper, upper.mTable[u].child);
      const Lower& lower = child<Lower>(upper, u);
      for (std::uint32_t l = 0; l < kLowerSlots; ++l) {
        if (lower.mChildMask.isOn(l)) leaves.take(&lower, lower.mTable[l].child);
      }
    }
  }
}

int offset(int x, int y, int z) { return (x & 7) << 6 | (y & 7) << 3 | (z & 7); }

// The block around a voxel.
struct Found {
  const float* values;
  float value;

  float at(int x, int y, int z) const {
    return values == nullptr ? value : values[offset(x, y, z)];
  }
};

std::uint32_t slot_of(int x, int y, int z, std::uint32_t log2, std::uint32_t log2_child) {
  const std::uint32_t mask = (1u << log2) - 1u;
  const auto along = [&](int v) { return static_cast<std::uint32_t>(v) >> log2_child & mask; };
  return along(x) << 2 * log2 | along(y) << log2 | along(z);
}

Found find(const Root& root, int x, int y, int z) {
  const auto key = Root::CoordToKey(nanovdb::Coord(x, y, z));
  for (std::uint32_t t = 0; t < root.mTableSize; ++t) {
    const auto& tile = *root.tile(t);
    if (tile.key != key) continue;
    if (!tile.isChild()) return {nullptr, tile.value};
    const Upper& upper = child(root, t);
    const std::uint32_t u = slot_of(x, y, z, 5, 7);
    if (!upper.mChildMask.isOn(u)) return {nullptr, upper.mTable[u].value};
    const Lower& lower = child<Lower>(upper, u);
    const std::uint32_t l = slot_of(x, y, z, 4, 3);
    if (!lower.mChildMask.isOn(l)) return {nullptr, lower.mTable[l].value};
    return {child<Leaf>(lower, l).mValues, 0.0f};
  }
  return {nullptr, root.mBackground};
}

std::string place(const FloatGrid::Block& block, std::int64_t i) {
  const auto o = block.origin;
  return "at voxel " + std::to_string(o[0] + i / 64) + ", " + std::to_string(o[1] + i / 8 % 8) +
         ", " + std::to_string(o[2] + i % 8);
}

}  // namespace

FloatGrid FloatGrid::map(const std::filesystem::path& file) {
  MappedFile mapped = map_file(file);
  return {std::move(mapped.bytes), mapped.size};
}

FloatGrid::FloatGrid(std::span<const std::byte> bytes) : size_(bytes.size()) {
  constexpr std::size_t kAlignment = 64;
  void* copy = std::aligned_alloc(kAlignment, (size_ + kAlignment - 1) / kAlignment * kAlignment);
  if (copy == nullptr) throw std::bad_alloc();
  std::memcpy(copy, bytes.data(), size_);
  bytes_ = Bytes(static_cast<std::byte*>(copy), [](std::byte* b) { std::free(b); });
  check();
}

FloatGrid::FloatGrid(Bytes bytes, std::size_t size) : bytes_(std::move(bytes)), size_(size) {
  check();
}

void FloatGrid::check() {
  check_size(size_);
  const Grid& grid = *at<Grid>(bytes_.get(), 0);
  check_header(grid, size_);
  check_nodes(bytes_.get(), size_);
  const auto& map = grid.mMap;
  for (const double number : map.mMatD) {
    if (!std::isfinite(number)) refuse("with a transform that is not finite");
  }
  for (const double number : map.mVecD) {
    if (!std::isfinite(number)) refuse("with a transform that is not finite");
  }
  matrix_ = {{map.mMatD[0], map.mMatD[1], map.mMatD[2]},
             {map.mMatD[3], map.mMatD[4], map.mMatD[5]},
             {map.mMatD[6], map.mMatD[7], map.mMatD[8]}};
  shift_ = {map.mVecD[0], map.mVecD[1], map.mVecD[2]};
  background_ = root_of(bytes_.get()).mBackground;
  if (!sound(background_)) refuse("whose background is negative or not finite");
  majorant_ = background_;
  constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
  box_ = {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for_each_block([this](const Block& block) {
    float majorant = block.value;
    if (block.values != nullptr) {
      bool good = true;
      for (int i = 0; i < 512; ++i) {
        good &= sound(block.values[i]);
        majorant = std::max(majorant, block.values[i]);
      }
      if (!good) {
        const auto* bad = std::find_if_not(block.values, block.values + 512, sound);
        refuse("with a value that is negative or not finite " + place(block, bad - block.values));
      }
    } else if (!sound(block.value)) {
      refuse("with a value that is negative or not finite " + place(block, 0));
    }
    majorant_ = std::max(majorant_, majorant);
    if (block.values == nullptr && block.value == background_) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box_.low[axis] = std::min(box_.low[axis], block.origin[axis]);
      box_.high[axis] = std::max(box_.high[axis], block.origin[axis] + block.size - 1);
    }
  });
  if (box_.low[0] > box_.high[0]) refuse("without voxels");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (box_.low[axis] < -kFarthest || box_.high[axis] > kFarthest) refuse("that reaches too far");
  }
}

void FloatGrid::for_each_block(const std::function<void(const Block&)>& f) const {
  const Root& root = root_of(bytes_.get());
  for (std::uint32_t t = 0; t < root.mTableSize; ++t) {
    const auto corner = root.tile(t)->origin();
    const std::array<std::int64_t, 3> origin{corner[0], corner[1], corner[2]};
    if (!root.tile(t)->isChild()) {
      f({origin, 4096, nullptr, root.tile(t)->value});
      continue;
    }
    const Upper& upper = child(root, t);
    for (std::uint32_t u = 0; u < kUpperSlots; ++u) {
      const auto at_u = slot<5>(origin, u, 128);
      if (!upper.mChildMask.isOn(u)) {
        f({at_u, 128, nullptr, upper.mTable[u].value});
        continue;
      }
      const Lower& lower = child<Lower>(upper, u);
      for (std::uint32_t l = 0; l < kLowerSlots; ++l) {
        const auto at_l = slot<4>(at_u, l, 8);
        if (lower.mChildMask.isOn(l)) {
          f({at_l, 8, child<Leaf>(lower, l).mValues, 0.0f});
        } else {
          f({at_l, 8, nullptr, lower.mTable[l].value});
        }
      }
    }
  }
}

float FloatGrid::value(int x, int y, int z) const {
  return find(root_of(bytes_.get()), x, y, z).at(x, y, z);
}

std::array<float, 8> FloatGrid::corners(int x, int y, int z) const {
  const Root& root = root_of(bytes_.get());
  std::array<Found, 8> blocks;
  blocks[0] = find(root, x, y, z);
  const auto last = [](int v) { return static_cast<unsigned>((v & 7) == 7); };
  // Along which axes the corners lie in two blocks.
  const unsigned across = last(x) << 2 | last(y) << 1 | last(z);
  if (across == 0 && blocks[0].values != nullptr) {
    const float* low = blocks[0].values + offset(x, y, z);
    return {low[0], low[1], low[8], low[9], low[64], low[65], low[72], low[73]};
  }
  std::array<float, 8> all;
  for (unsigned i = 0; i < 8; ++i) {
    const auto bit = [&](unsigned n) { return static_cast<int>(i >> n & 1u); };
    const int cx = x + bit(2), cy = y + bit(1), cz = z + bit(0);
    // The first corner in a block finds it for those that follow.
    const unsigned block = i & across;
    if (i > 0 && block == i) blocks[i] = find(root, cx, cy, cz);
    all[i] = blocks[block].at(cx, cy, cz);
  }
  return all;
}

}  // namespace nocturne

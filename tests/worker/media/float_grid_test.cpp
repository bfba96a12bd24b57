// Grids that are damaged, on purpose or not: refused in words or harmless, never a crash. Run it
// under the address sanitizer, too (`make sanitize`).
#include "media/float_grid.h"

#include <gtest/gtest.h>
#include <nanovdb/NanoVDB.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

#include "grid_bytes.h"
#include "majorant_checks.h"
#include "media/grid_density.h"
#include "pdfs/directions.h"

namespace nocturne {
namespace {

constexpr std::array<double, 12> kAsItIs{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

using Bytes = std::vector<std::byte>;
using Grid = nanovdb::GridData;
using Tree = nanovdb::TreeData<3>;
using Root = nanovdb::NanoRoot<float>::DataType;
using Upper = nanovdb::NanoUpper<float>::DataType;
using Lower = nanovdb::NanoLower<float>::DataType;
using Leaf = nanovdb::NanoLeaf<float>::DataType;

// A few leaves under two root nodes, and a tile.
const Bytes& good() {
  static const Bytes bytes = test::grid_bytes(
      [](int x, int y, int z) {
        return x >= 8 && y >= 8 && z >= 8 ? 2.0f : 0.01f * static_cast<float>(x * x + y + z + 20);
      },
      {-9, 0, 0}, {15, 15, 15}, 0.0f, {0.5, 0, 0, 1, 0, 0.5, 0, 2, 0, 0, 0.5, 3});
  return bytes;
}

// Why bytes are refused; empty if they are not. An accepted grid is looked up everywhere.
std::string refusal(const Bytes& bytes) {
  try {
    const auto grid = std::make_shared<const FloatGrid>(std::span(bytes));
    const GridDensity density({grid, kAsItIs, 1.0, false});
    for (std::uint32_t i = 0; i < 64; ++i) {
      const auto u = test::media_numbers(i, 1), v = test::media_numbers(i, 2);
      const Ray ray{{16 * u[0] - 4, 16 * u[1] - 2, 16 * u[2] - 2},
                    UniformSphere::sample(v[0], v[1])};
      GridMajorants majorants(density, ray, 50.0f);
      EXPECT_TRUE(std::isfinite(majorants.density(0.0f)));
      MajorantSegment segment;
      while (majorants.next(segment)) EXPECT_GE(segment.majorant, 0.0f);
    }
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

// Nodes in a copy of the good bytes.
struct Damaged {
  Bytes bytes = good();

  template <class T>
  T& at(std::size_t offset) {
    return *reinterpret_cast<T*>(bytes.data() + offset);
  }
  Grid& grid() { return at<Grid>(0); }
  Tree& tree() { return at<Tree>(sizeof(Grid)); }
  Root& root() { return at<Root>(sizeof(Grid) + tree().mNodeOffset[3]); }
  Upper& upper() { return at<Upper>(sizeof(Grid) + tree().mNodeOffset[2]); }
  Lower& lower() { return at<Lower>(sizeof(Grid) + tree().mNodeOffset[1]); }
  Leaf& leaf() { return at<Leaf>(sizeof(Grid) + tree().mNodeOffset[0]); }
};

template <class Damage>
void expect_refused(const Damage& damage, const std::string& words) {
  Damaged damaged;
  damage(damaged);
  EXPECT_NE(refusal(damaged.bytes).find(words), std::string::npos)
      << words << " / " << refusal(damaged.bytes);
}

template <class Node>
std::uint32_t first_child(const Node& node) {
  std::uint32_t slot = 0;
  while (!node.mChildMask.isOn(slot)) ++slot;
  return slot;
}

TEST(FloatGrid, RefusesWhatIsNoGridOfFloats) {
  ASSERT_EQ(refusal(good()), "");
  expect_refused([](Damaged& d) { d.grid().mMagic ^= 1; }, "no NanoVDB buffer");
  expect_refused([](Damaged& d) { d.grid().mVersion = nanovdb::Version(31, 0, 0); }, "version 31");
  expect_refused([](Damaged& d) { d.grid().mGridType = nanovdb::GridType::Double; }, "type float");
  expect_refused([](Damaged& d) { d.grid().mGridSize += 32; }, "header says");
  expect_refused([](Damaged& d) { d.bytes.resize(d.bytes.size() - 32); }, "header says");
  expect_refused([](Damaged& d) { d.bytes.resize(100); }, "too short");
  expect_refused([](Damaged& d) { d.bytes.clear(); }, "too short");
  expect_refused([](Damaged& d) { d.grid().mMap.mVecD[1] = std::nan(""); }, "transform");
  expect_refused([](Damaged& d) { d.grid().mMap.mMatD[4] = 0.0; }, "no inverse");
}

TEST(FloatGrid, RefusesNodesOutOfPlace) {
  expect_refused([](Damaged& d) { d.tree().mNodeOffset[3] = ~std::uint64_t{31}; }, "root outside");
  expect_refused([](Damaged& d) { d.tree().mNodeOffset[3] = d.bytes.size(); }, "root outside");
  expect_refused([](Damaged& d) { d.tree().mNodeOffset[3] += 4; }, "root outside");
  expect_refused([](Damaged& d) { d.root().mTableSize = 1'000'000'000; }, "at its root");
  expect_refused(
      [](Damaged& d) {
        d.tree().mNodeOffset[3] = d.bytes.size() - sizeof(Grid) - sizeof(Root);
        d.root().mTableSize = 1;
      },
      "longer than its bytes");
  for (const std::size_t level : {0u, 1u, 2u}) {
    // A billion of them.
    expect_refused([&](Damaged& d) { d.tree().mNodeCount[level] = 1'000'000'000; }, "outside");
    expect_refused([&](Damaged& d) { d.tree().mNodeCount[level] = 0; }, "outside of its place");
    expect_refused([&](Damaged& d) { d.tree().mNodeOffset[level] = ~std::uint64_t{31}; },
                   "outside");
    expect_refused([&](Damaged& d) { d.tree().mNodeOffset[level] += 4; }, "outside");
  }
  for (const std::int64_t off : {std::int64_t{1} << 62, std::int64_t{-1} << 63, std::int64_t{-32},
                                 std::int64_t{1}, std::int64_t{4096}}) {
    expect_refused([&](Damaged& d) { d.upper().mTable[first_child(d.upper())].child += off; },
                   "outside of its place");
    expect_refused([&](Damaged& d) { d.lower().mTable[first_child(d.lower())].child += off; },
                   "outside of its place");
  }
  // A tree that is a hundred million times as large as its bytes.
  expect_refused(
      [](Damaged& d) {
        const std::uint32_t first = first_child(d.lower());
        for (std::uint32_t i = 0; i < 4096; ++i) {
          d.lower().mTable[i].child = d.lower().mTable[first].child;
          d.lower().mChildMask.setOn(i);
        }
      },
      "two parents");
}

TEST(FloatGrid, RefusesValuesThatAreNoDensities) {
  for (const float bad : {-1e-30f, -1.0f, std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    expect_refused([&](Damaged& d) { d.leaf().mValues[100] = bad; }, "at voxel");
    expect_refused([&](Damaged& d) { d.root().mBackground = bad; }, "background");
    expect_refused(
        [&](Damaged& d) {
          std::uint32_t tile = 0;
          while (d.lower().mChildMask.isOn(tile)) ++tile;
          d.lower().mTable[tile].value = bad;
        },
        "at voxel");
  }
  Damaged where;
  where.leaf().mValues[(3 << 6) + (4 << 3) + 5] = -1.0f;
  // The first leaf starts at -16, 0, 0.
  EXPECT_NE(refusal(where.bytes).find("at voxel -13, 4, 5"), std::string::npos)
      << refusal(where.bytes);
}

TEST(FloatGrid, RefusesAGridOfNothing) {
  EXPECT_NE(refusal(test::grid_bytes([](int, int, int) { return 0.0f; }, {0, 0, 0}, {9, 9, 9}))
                .find("without voxels"),
            std::string::npos);
  // Of one value that is the background's.
  EXPECT_NE(
      refusal(test::grid_bytes([](int, int, int) { return 1.0f; }, {0, 0, 0}, {9, 9, 9}, 1.0f))
          .find("without voxels"),
      std::string::npos);
}

TEST(FloatGrid, MapsAFileAndNothingElse) {
  const auto file = std::filesystem::path(testing::TempDir()) / "float_grid_test.nvdb";
  const auto write = [&](const Bytes& bytes) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  };
  write(good());
  EXPECT_EQ(FloatGrid::map(file).majorant(), FloatGrid(std::span(good())).majorant());
  // It goes on being read after it was removed.
  const FloatGrid removed = FloatGrid::map(file);
  std::filesystem::remove(file);
  EXPECT_EQ(removed.value(8, 8, 8), 2.0f);
  write(good());
  // As large as a grid may be, with nothing in it: refused by its header, and no memory is taken.
  std::filesystem::resize_file(file, FloatGrid::kMaxBytes);
  EXPECT_THROW(FloatGrid::map(file), std::invalid_argument);
  std::filesystem::resize_file(file, FloatGrid::kMaxBytes + 1);
  EXPECT_THROW(FloatGrid::map(file), std::invalid_argument);
  for (const std::size_t size : {std::size_t{0}, std::size_t{671}, good().size() - 1}) {
    write({good().begin(), good().begin() + static_cast<std::ptrdiff_t>(size)});
    EXPECT_THROW(FloatGrid::map(file), std::invalid_argument);
  }
  std::filesystem::remove(file);
  EXPECT_THROW(FloatGrid::map(file), std::invalid_argument);
}

// Kilobytes of this process that it shares with nobody.
std::size_t own_memory() {
  std::ifstream in("/proc/self/smaps_rollup");
  for (std::string name; in >> name;) {
    std::size_t kilobytes = 0;
    if (name == "Anonymous:" && in >> kilobytes) return kilobytes;
  }
  return 0;
}

TEST(FloatGrid, TakesNoMemoryOfItsOwnForAFile) {
  const auto file = std::filesystem::path(testing::TempDir()) / "float_grid_memory_test.nvdb";
  {
    const Bytes bytes = test::grid_bytes(
        [](int x, int y, int z) { return 1.0f + 0.1f * static_cast<float>((x + y + z) % 7); },
        {0, 0, 0}, {255, 255, 127});
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  const std::size_t before = own_memory();
  ASSERT_GT(before, 0u);
  const FloatGrid grid = FloatGrid::map(file);
  const std::size_t after = own_memory();
  std::filesystem::remove(file);
  ASSERT_GT(grid.size(), std::size_t{32} << 20);
  EXPECT_LT(after, before + grid.size() / 1024 / 16);
}

// Numbers in the places that matter: headers, masks, offsets, keys. Any bit of them, one to four at
// a time; and random words, which small changes don't reach.
TEST(FloatGrid, SurvivesDamage) {
  const std::size_t tree = sizeof(Grid), size = good().size();
  Damaged layout;
  const auto offset = [&](std::size_t level) {
    return sizeof(Grid) + layout.tree().mNodeOffset[level];
  };
  struct Range {
    std::size_t from, to;
  };
  const Range ranges[]{{0, tree},
                       {tree, tree + sizeof(Tree)},
                       {offset(3), offset(3) + sizeof(Root) + 2 * sizeof(Root::Tile)},
                       {offset(2), offset(2) + 2 * sizeof(Upper)},
                       {offset(1), offset(1) + 2 * sizeof(Lower)},
                       {offset(0), size},
                       {0, size}};
  std::uint32_t refused = 0, all = 0;
  for (const Range& range : ranges) {
    for (int turn = 0; turn < 200; ++turn, ++all) {
      Bytes bytes = good();
      const auto u = test::media_numbers(all, 3);
      const int changes = 1 + static_cast<int>(4.0f * u[0]);
      for (int change = 0; change < changes; ++change) {
        const auto v = test::media_numbers(4 * all + static_cast<std::uint32_t>(change), 4);
        const auto span = static_cast<double>(range.to - range.from);
        const auto place = range.from + static_cast<std::size_t>(v[0] * span);
        if (turn % 2 == 0) {
          bytes[place] ^= std::byte{1} << static_cast<int>(8.0f * v[1]);
        } else {
          const auto words = philox4x32({all, static_cast<std::uint32_t>(change), 0, 0}, {5, 6});
          const std::size_t length = v[1] < 0.5f ? 4 : 8, first = place / length * length;
          std::memcpy(&bytes[first], words.data(), std::min(length, size - first));
        }
      }
      refused += refusal(bytes).empty() ? 0 : 1;
      if (HasFatalFailure()) return;
    }
  }
  // Both happen, or the test would not look where it should.
  EXPECT_GT(refused, all / 10);
  EXPECT_LT(refused, all - all / 10);
}

}  // namespace
}  // namespace nocturne

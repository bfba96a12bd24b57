#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "luminaires/cutpoint_table.h"

namespace nocturne {
namespace {

// Rows with cells of no weight, and of weights that differ by up to 2^50.
std::vector<std::vector<std::uint64_t>> rows_of(std::uint32_t cells, std::mt19937_64& random) {
  std::vector<std::vector<std::uint64_t>> rows;
  for (const unsigned bits : {1u, 8u, 50u}) {
    std::vector<std::uint64_t> sums{0};
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint64_t weight = random() >> (64 - 1 - random() % bits);
      sums.push_back(sums.back() + (random() % 3 == 0 ? 0 : weight));
    }
    sums.back() += 1;
    rows.push_back(std::move(sums));
  }
  return rows;
}

TEST(CutpointTable, FindsTheLastCellThatBeginsBefore) {
  std::mt19937_64 random(7);
  for (const std::uint32_t cells : {1u, 2u, 3u, 5u, 64u, 1000u}) {
    const auto rows = rows_of(cells, random);
    CutpointTable guide(cells);
    for (const auto& sums : rows) guide.add(sums.data());
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const auto& sums = rows[row];
      const std::uint64_t last = sums.back();
      std::vector<std::uint64_t> targets{0, last - 1};
      for (int i = 0; i < 2000; ++i) targets.push_back(random() % last);
      for (const std::uint64_t sum : sums) {
        if (sum < last) targets.push_back(sum);
        if (sum > 0) targets.push_back(sum - 1);
      }
      for (const std::uint64_t target : targets) {
        const auto after = std::upper_bound(sums.begin(), sums.end(), target);
        const auto range = guide.range(row, last, target);
        EXPECT_EQ(CutpointTable::find(range, sums.data(), target), after - sums.begin() - 1);
        EXPECT_LE(range.first + range.count, cells);
      }
    }
  }
}

}  // namespace
}  // namespace nocturne

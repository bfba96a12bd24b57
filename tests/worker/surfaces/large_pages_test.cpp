#include "surfaces/large_pages.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace nocturne {
namespace {

TEST(LargePages, HoldWhatGrowsAndBeginWhereAPageDoes) {
  std::vector<std::uint64_t, LargePages<std::uint64_t>> numbers;
  for (std::uint64_t i = 0; i < 1'000'000; ++i) numbers.push_back(i);
  numbers.shrink_to_fit();
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.data()) % LargePages<std::uint64_t>::kPage,
            0u);
  for (std::uint64_t i = 0; i < numbers.size(); ++i) ASSERT_EQ(numbers[i], i);
}

TEST(LargePages, AreNotTakenForLittle) {
  std::vector<std::uint64_t, LargePages<std::uint64_t>> numbers{1, 2, 3};
  const auto copy = numbers;
  numbers.clear();
  EXPECT_EQ(copy.back(), 3u);
}

}  // namespace
}  // namespace nocturne

// Where in a row of sums a whole number falls.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nocturne {

/// For rows of whole sums that begin at 0, do not decrease and end at most at 2^63: of equal slices
/// of each row, the first sum that a number of the slice can fall at (Chen and Asau, 1974), so that
/// few are looked at.
class CutpointTable {
 public:
  /// Rows have `cells` cells, at most 2^16, and so one sum more.
  explicit CutpointTable(std::uint32_t cells)
      : cells_(cells), bits_(static_cast<std::uint32_t>(std::bit_width(cells / 16))) {}

  /// The next row.
  void add(const std::uint64_t* sums) {
    std::uint32_t cell = 0;
    for (std::uint64_t slice = 0; slice < slices(); ++slice) {
      const std::uint64_t begin = slice << shift(sums[cells_]);
      while (cell + 1 < cells_ && sums[cell + 1] <= begin) ++cell;
      first_.push_back(static_cast<std::uint16_t>(cell));
    }
  }

  /// Cells that a number can be in.
  struct Range {
    std::uint32_t first, count;
  };
  /// Of `target`, which is below `last`, the row's last sum.
  Range range(std::size_t row, std::uint64_t last, std::uint64_t target) const {
    const std::uint16_t* first = &first_[row * slices() + (target >> shift(last))];
    return {first[0], first[1] + 1u - first[0]};
  }

  /// The last cell of the range that begins at `target` or before.
  static std::uint32_t find(Range range, const std::uint64_t* sums, std::uint64_t target) {
    while (range.count > 1) {  // without a jump that nobody can foresee
      const std::uint32_t half = range.count / 2;
      range.first += sums[range.first + half] <= target ? half : 0;
      range.count -= half;
    }
    return range.first;
  }

 private:
  // And one, where the last one ends.
  std::size_t slices() const { return (std::size_t{1} << bits_) + 1; }
  std::uint32_t shift(std::uint64_t last) const {
    const auto width = static_cast<std::uint32_t>(std::bit_width(last));
    return width > bits_ ? width - bits_ : 0;
  }

  std::uint32_t cells_, bits_;
  std::vector<std::uint16_t> first_;
};

}  // namespace nocturne

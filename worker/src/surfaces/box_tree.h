// Which of many boxes are near each other.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "math/box.h"

namespace nocturne {

/// Boxes, or a type derived from them; each set is cut at the middle one along its longest axis.
template <class B>
class BoxTree {
 public:
  explicit BoxTree(std::vector<B> boxes)
      : boxes_(std::move(boxes)), nodes_(2 * std::bit_ceil(boxes_.size() / kFew + 1)) {
    if (!boxes_.empty()) build(1, 0, boxes_.size());
  }

  /// Whether close(a, b) of any two boxes within reach of each other.
  template <class Close>
  bool any_pair(double reach, const Close& close) const {
    return !boxes_.empty() && within(1, reach, close);
  }
  /// The same of one from each tree.
  template <class Close>
  bool any_pair_with(const BoxTree& other, double reach, const Close& close) const {
    return !boxes_.empty() && !other.boxes_.empty() && between(1, other, 1, reach, close);
  }

 private:
  static constexpr std::size_t kFew = 4;

  // Its children are 2 i and 2 i + 1.
  struct Node {
    std::size_t first = 0, count = 0;
    Box all;
  };

  bool is_leaf(std::size_t i) const { return nodes_[i].count <= kFew; }
  std::span<const B> boxes_of(std::size_t i) const {
    return std::span(boxes_).subspan(nodes_[i].first, nodes_[i].count);
  }

  void build(std::size_t i, std::size_t first, std::size_t count) {
    nodes_[i] = {first, count, around(std::span(boxes_).subspan(first, count))};
    if (is_leaf(i)) return;
    const Vec3 size = nodes_[i].all.high - nodes_[i].all.low;
    const auto axis = size.x >= std::max(size.y, size.z) ? &Vec3::x
                      : size.y >= size.z                 ? &Vec3::y
                                                         : &Vec3::z;
    const auto begin = boxes_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto half = static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(begin, begin + half, begin + static_cast<std::ptrdiff_t>(count),
                     [axis](const B& a, const B& b) {
                       return a.low.*axis + a.high.*axis < b.low.*axis + b.high.*axis;
                     });
    build(2 * i, first, count / 2);
    build(2 * i + 1, first + count / 2, count - count / 2);
  }

  template <class Close>
  bool within(std::size_t i, double reach, const Close& close) const {
    if (!is_leaf(i)) {
      return within(2 * i, reach, close) || within(2 * i + 1, reach, close) ||
             between(2 * i, *this, 2 * i + 1, reach, close);
    }
    const auto boxes = boxes_of(i);
    for (std::size_t a = 0; a < boxes.size(); ++a) {
      for (std::size_t b = a + 1; b < boxes.size(); ++b) {
        if (reaches(boxes[a], boxes[b], reach) && close(boxes[a], boxes[b])) return true;
      }
    }
    return false;
  }

  template <class Close>
  bool between(std::size_t i, const BoxTree& other, std::size_t j, double reach,
               const Close& close) const {
    if (!reaches(nodes_[i].all, other.nodes_[j].all, reach)) return false;
    if (is_leaf(i) && other.is_leaf(j)) {
      return std::ranges::any_of(boxes_of(i), [&](const B& a) {
        return std::ranges::any_of(other.boxes_of(j),
                                   [&](const B& b) { return reaches(a, b, reach) && close(a, b); });
      });
    }
    if (is_leaf(i) || (!other.is_leaf(j) && other.nodes_[j].count > nodes_[i].count)) {
      return between(i, other, 2 * j, reach, close) || between(i, other, 2 * j + 1, reach, close);
    }
    return between(2 * i, other, j, reach, close) || between(2 * i + 1, other, j, reach, close);
  }

  std::vector<B> boxes_;
  std::vector<Node> nodes_;
};

}  // namespace nocturne

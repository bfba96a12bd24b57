#include "surfaces/thin_shapes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "surfaces/exact_crossing.h"

namespace nocturne {
namespace {

// Pairs of triangles that are looked at before meshes count as thin or close: a tenth of a second.
constexpr std::size_t kMaxPairs = 30'000'000;

struct Box {
  std::uint32_t triangle;
  Vec3 low, high;
};

using Triangle = std::array<Double3, 3>;

Triangle triangle_of(const TriangleMesh& mesh, std::uint32_t index) {
  const auto& t = mesh.triangles[index];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

Vec3 smaller(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3 larger(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

Box box_of(const TriangleMesh& mesh, std::uint32_t index) {
  const auto& t = mesh.triangles[index];
  const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
  return {index, smaller(a, smaller(b, c)), larger(a, larger(b, c))};
}

// Around them all; of none, one that nothing reaches.
Box around(std::span<const Box> boxes) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  Box all{0, {kInfinite, kInfinite, kInfinite}, {-kInfinite, -kInfinite, -kInfinite}};
  for (const Box& box : boxes) {
    all.low = smaller(all.low, box.low);
    all.high = larger(all.high, box.high);
  }
  return all;
}

bool reaches(const Box& a, const Box& b, double reach) {
  return std::max({b.low.x - a.high.x, a.low.x - b.high.x, b.low.y - a.high.y, a.low.y - b.high.y,
                   b.low.z - a.high.z, a.low.z - b.high.z}) <= reach;
}

// Between what two triangles cover along an axis, over its length.
double gap_along(Double3 axis, const Triangle& a, const Triangle& b) {
  const double norm = length(axis);
  if (!(norm > 0.0)) return 0.0;
  const auto range = [&](const Triangle& t) {
    return std::minmax({dot(axis, t[0]), dot(axis, t[1]), dot(axis, t[2])});
  };
  const auto [a_low, a_high] = range(a);
  const auto [b_low, b_high] = range(b);
  return std::max(b_low - a_high, a_low - b_high) / norm;
}

// By separating axes (Gottschalk, Lin and Manocha, "OBBTree", SIGGRAPH 1996): a gap along any is a
// lower bound of the distance, and triangles that are apart have one along one of these.
bool apart(const Triangle& a, const Triangle& b, double reach) {
  const auto edges = [](const Triangle& t) {
    return std::array{t[1] - t[0], t[2] - t[1], t[0] - t[2]};
  };
  const auto of_a = edges(a), of_b = edges(b);
  const auto separates = [&](Double3 axis) { return gap_along(axis, a, b) > reach; };
  const Double3 normal_a = cross(of_a[0], of_a[1]), normal_b = cross(of_b[0], of_b[1]);
  if (separates(normal_a) || separates(normal_b)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    // In its plane, across each edge: for those in one plane.
    if (separates(cross(normal_a, of_a[i])) || separates(cross(normal_b, of_b[i]))) return true;
    for (const Double3 edge : of_b) {
      if (separates(cross(of_a[i], edge))) return true;
    }
  }
  return false;
}

// Not unit. Slivers, as at the poles of a ball, face anywhere: zero.
Double3 normal(const Triangle& t) {
  const Double3 u = t[1] - t[0], v = t[2] - t[0], n = cross(u, v);
  const double rounding = kDoubleUnits * max_abs(t[0]) * std::max(max_abs(u), max_abs(v));
  return max_abs(n) > rounding ? n : Double3{0, 0, 0};
}

// Between two parts of one surface that face the same way there is nothing thin, however fine the
// mesh; at a right angle no more than at an edge.
bool face_away(const Triangle& a, const Triangle& b) { return dot(normal(a), normal(b)) < 0.0; }

// Surfaces that cross each other at an angle are close in a strip as wide as the reach: no more
// than at an edge.
bool may_lie_along(const Triangle& a, const Triangle& b) {
  constexpr double kMinCosine = 0.866;  // 30 degrees
  const Double3 m = normal(a), n = normal(b);
  return std::fabs(dot(m, n)) > kMinCosine * length(m) * length(n);
}

// Boxes of triangles, each cut at the middle one along its longest axis.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes)
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
  std::span<const Box> boxes_of(std::size_t i) const {
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
                     [axis](const Box& a, const Box& b) {
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
      return std::ranges::any_of(boxes_of(i), [&](const Box& a) {
        return std::ranges::any_of(
            other.boxes_of(j), [&](const Box& b) { return reaches(a, b, reach) && close(a, b); });
      });
    }
    if (is_leaf(i) || (!other.is_leaf(j) && other.nodes_[j].count > nodes_[i].count)) {
      return between(i, other, 2 * j, reach, close) || between(i, other, 2 * j + 1, reach, close);
    }
    return between(2 * i, other, j, reach, close) || between(2 * i + 1, other, j, reach, close);
  }

  std::vector<Box> boxes_;
  std::vector<Node> nodes_;
};

std::vector<Box> boxes_of(const TriangleMesh& mesh) {
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) boxes.push_back(box_of(mesh, i));
  return boxes;
}

bool may_be_thin(const TriangleMesh& mesh, double reach) {
  std::size_t pairs = 0;
  return BoxTree(boxes_of(mesh)).any_pair(reach, [&](const Box& a, const Box& b) {
    if (++pairs > kMaxPairs) return true;
    const Triangle one = triangle_of(mesh, a.triangle), other = triangle_of(mesh, b.triangle);
    return face_away(one, other) && !share_corner(mesh, a.triangle, b.triangle) &&
           !apart(one, other, reach);
  });
}

bool may_be_close(const TriangleMesh& a, const TriangleMesh& b, double reach) {
  std::size_t pairs = 0;
  const auto close = [&](const Box& of_a, const Box& of_b) {
    if (++pairs > kMaxPairs) return true;
    const Triangle one = triangle_of(a, of_a.triangle), other = triangle_of(b, of_b.triangle);
    return may_lie_along(one, other) && !apart(one, other, reach);
  };
  // Trees of what may matter only: a mesh is asked about with each that stands by it.
  std::vector<Box> boxes_a = boxes_of(a), boxes_b = boxes_of(b);
  const auto keep_by = [reach](std::vector<Box>& boxes, const Box& other) {
    std::erase_if(boxes, [&](const Box& box) { return !reaches(box, other, reach); });
  };
  keep_by(boxes_a, around(boxes_b));
  keep_by(boxes_b, around(boxes_a));
  return BoxTree(std::move(boxes_a)).any_pair_with(BoxTree(std::move(boxes_b)), reach, close);
}

}  // namespace

bool may_be_thin(const Shape& shape, double reach) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
    return mesh->time_steps > 1 || may_be_thin(*mesh, reach);
  }
  return std::get<Sphere>(shape).radius < 4.0 * reach;
}

bool may_be_close(const Shape& a, const Shape& b, double reach) {
  const auto* one = std::get_if<TriangleMesh>(&a);
  const auto* other = std::get_if<TriangleMesh>(&b);
  if (one == nullptr || other == nullptr || one->time_steps > 1 || other->time_steps > 1)
    return true;
  return may_be_close(*one, *other, reach);
}

}  // namespace nocturne

#include "surfaces/thin_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surfaces/exact_crossing.h"

namespace nocturne {
namespace {

// Pairs of triangles that are looked at before a mesh counts as thin: a tenth of a second.
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

Box box_of(const TriangleMesh& mesh, std::uint32_t index) {
  const auto& t = mesh.triangles[index];
  Box box{index, mesh.vertices[t[0]], mesh.vertices[t[0]]};
  for (const std::uint32_t corner : {t[1], t[2]}) {
    const Vec3 p = mesh.vertices[corner];
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
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

bool may_be_thin(const TriangleMesh& mesh, double reach) {
  if (mesh.time_steps > 1) return true;
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) boxes.push_back(box_of(mesh, i));
  std::sort(boxes.begin(), boxes.end(),
            [](const Box& a, const Box& b) { return a.low.x < b.low.x; });
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Box& a = boxes[i];
    for (std::size_t j = i + 1; j < boxes.size() && boxes[j].low.x - a.high.x <= reach; ++j) {
      if (++pairs > kMaxPairs) return true;
      const Box& b = boxes[j];
      if (std::max({b.low.y - a.high.y, a.low.y - b.high.y, b.low.z - a.high.z,
                    a.low.z - b.high.z}) > reach) {
        continue;
      }
      if (!share_corner(mesh, a.triangle, b.triangle) &&
          !apart(triangle_of(mesh, a.triangle), triangle_of(mesh, b.triangle), reach)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

bool may_be_thin(const Shape& shape, double reach) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return may_be_thin(*mesh, reach);
  return std::get<Sphere>(shape).radius < 4.0 * reach;
}

}  // namespace nocturne

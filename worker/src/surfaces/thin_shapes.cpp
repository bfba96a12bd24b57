#include "surfaces/thin_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "surfaces/box_tree.h"
#include "surfaces/exact_crossing.h"

namespace nocturne {
namespace {

// Pairs of triangles that are looked at before meshes count as thin or close: a tenth of a second.
constexpr std::size_t kMaxPairs = 30'000'000;

using Triangle = std::array<Double3, 3>;

Triangle triangle_of(const TriangleMesh& mesh, std::uint32_t index) {
  const auto& t = mesh.triangles[index];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

struct TriangleBox : Box {
  std::uint32_t number;
};

TriangleBox box_of(const TriangleMesh& mesh, std::uint32_t index) {
  const auto& t = mesh.triangles[index];
  const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
  return {{smaller(a, smaller(b, c)), larger(a, larger(b, c))}, index};
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

// Between two parts of one surface that face in the same direction there is nothing thin, however
// fine the mesh; at a right angle no more than at an edge.
bool face_away(const Triangle& a, const Triangle& b) { return dot(normal(a), normal(b)) < 0.0; }

// Surfaces that cross each other at an angle are close in a strip as wide as the reach: no more
// than at an edge.
bool may_lie_along(const Triangle& a, const Triangle& b) {
  constexpr double kMinCosine = 0.866;  // 30 degrees
  const Double3 m = normal(a), n = normal(b);
  return std::fabs(dot(m, n)) > kMinCosine * length(m) * length(n);
}

std::vector<TriangleBox> boxes_of(const TriangleMesh& mesh) {
  std::vector<TriangleBox> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) boxes.push_back(box_of(mesh, i));
  return boxes;
}

bool may_be_thin(const TriangleMesh& mesh, double reach) {
  std::size_t pairs = 0;
  return BoxTree(boxes_of(mesh)).any_pair(reach, [&](const TriangleBox& a, const TriangleBox& b) {
    if (++pairs > kMaxPairs) return true;
    const Triangle one = triangle_of(mesh, a.number), other = triangle_of(mesh, b.number);
    return face_away(one, other) && !share_corner(mesh, a.number, b.number) &&
           !apart(one, other, reach);
  });
}

bool may_be_close(const TriangleMesh& a, const TriangleMesh& b, double reach) {
  std::size_t pairs = 0;
  const auto close = [&](const TriangleBox& of_a, const TriangleBox& of_b) {
    if (++pairs > kMaxPairs) return true;
    const Triangle one = triangle_of(a, of_a.number), other = triangle_of(b, of_b.number);
    return may_lie_along(one, other) && !apart(one, other, reach);
  };
  // Trees only of the shapes that may matter: a mesh is asked about with each that stands by it.
  std::vector<TriangleBox> boxes_a = boxes_of(a), boxes_b = boxes_of(b);
  const auto keep_by = [reach](std::vector<TriangleBox>& boxes, const Box& other) {
    std::erase_if(boxes, [&](const Box& box) { return !reaches(box, other, reach); });
  };
  keep_by(boxes_a, around(boxes_b));
  keep_by(boxes_b, around(boxes_a));
  return BoxTree(std::move(boxes_a)).any_pair_with(BoxTree(std::move(boxes_b)), reach, close);
}

}  // namespace

bool may_be_thin(const Shape& shape, double reach) {
  return visit_shape(
      shape,
      [&](const TriangleMesh& mesh) { return mesh.time_steps > 1 || may_be_thin(mesh, reach); },
      [&](const Sphere& sphere) { return sphere.radius < 4.0 * reach; });
}

bool may_be_close(const Shape& a, const Shape& b, double reach) {
  const TriangleMesh *one = mesh_at_rest(a), *other = mesh_at_rest(b);
  return one == nullptr || other == nullptr || may_be_close(*one, *other, reach);
}

}  // namespace nocturne

// The binary hierarchy from which a tree of wide nodes is made.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "math/box.h"
#include "surfaces/shapes.h"
#include "surfaces/tree.h"

namespace nocturne {

/// A node, or a leaf.
struct Binary {
  /// In the place of a triangle's number: marks of shapes that are not meshes.
  static constexpr std::uint32_t kBall = ~0u, kInstance = kBall - 1;

  Box box;
  /// Below; none: a ball or an instance.
  std::uint32_t triangles = 0;
  bool is_leaf = true;
  /// cost[k]: of everything below as at most k + 1 children of one node; split[k]: how many of
  /// those are the first child's, 0 where it is itself one of them.
  std::array<float, Tree::kWidth> cost;
  std::array<std::uint8_t, Tree::kWidth> split;
  std::array<Binary*, 2> child;
  std::array<Tree::Triangle, Tree::kWidth> held;
};

/// What leaves are made of.
class Meshes {
 public:
  explicit Meshes(std::span<const Shape> shapes) : shapes_(shapes) {}

  std::array<Vec3, 3> corners(Tree::Triangle of) const {
    const auto& mesh = std::get<TriangleMesh>(shapes_[of.surface]);
    const auto& t = mesh.triangles[of.number];
    return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
  }
  /// Whether they have no more corners than a leaf, those at one place counted once.
  bool fit(std::span<const Tree::Triangle> all) const;

 private:
  std::span<const Shape> shapes_;
};

/// By Embree's builder (surface area heuristic, binned).
class BinaryHierarchy {
 public:
  /// Of primitives that are numbered by surface and triangle, or by Binary's numbers.
  /// std::runtime_error where it can't be built, and soon after a stop is requested.
  BinaryHierarchy(RTCDevice device, const Meshes& meshes,
                  std::vector<RTCBuildPrimitive>& primitives, std::stop_token stop);
  ~BinaryHierarchy() { rtcReleaseBVH(hierarchy_); }
  BinaryHierarchy(const BinaryHierarchy&) = delete;
  BinaryHierarchy& operator=(const BinaryHierarchy&) = delete;

  const Binary& top() const { return *top_; }

 private:
  const Meshes& meshes_;
  std::stop_token stop_;
  RTCBVH hierarchy_;
  Binary* top_;
};

}  // namespace nocturne

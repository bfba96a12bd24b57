// A hierarchy of boxes over shapes at rest, small enough to stay in a processor's caches
// where Embree's own tree is not. Nodes hold boxes in bytes (Ylitie, Karras and Laine, "Efficient
// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017), leaves hold corners that
// their triangles share.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "surfaces/instance.h"
#include "surfaces/large_pages.h"
#include "surfaces/shapes.h"
#include "surfaces/triangle_at.h"

namespace nocturne {

struct Tree {
  /// Children of a node; triangles of a leaf, and corners.
  static constexpr std::size_t kWidth = 8;
  /// Levels of nodes and leaves.
  static constexpr std::size_t kMaxDepth = 60;

  /// Number of a block, and its kind.
  enum class Kind : std::uint32_t { kNode, kTriangles, kBall, kInstance };
  using Reference = std::uint32_t;
  static constexpr Reference reference(std::size_t block, Kind kind) {
    return static_cast<Reference>(block) << 2 | static_cast<Reference>(kind);
  }
  static constexpr Kind kind(Reference to) { return static_cast<Kind>(to & 3u); }
  /// Blocks that a reference can tell apart, with three bits for a triangle.
  static constexpr std::size_t kMaxBlocks = std::size_t{1} << 27;

  /// Child i lies within base + scale x plane[0..2][i] and base + scale x plane[3..5][i], axis by
  /// axis. Children that are not there are leaves of nothing.
  struct Node {
    float base[4], scale[4];
    std::uint8_t plane[6][kWidth];
    Reference child[kWidth];
  };
  /// Triangle i has corners corner[0..2][i] of coordinates[axis]; those that are not there have the
  /// first corner three times.
  struct Triangles {
    float coordinates[3][kWidth];
    std::uint8_t corner[3][kWidth];
    /// The first one's place in `triangles`.
    std::uint32_t first;
  };
  /// Of a ball its surface, or the instance's number.
  struct Alone {
    std::uint32_t number;
  };
  union alignas(128) Block {
    Node node;
    Triangles triangles;
    Alone alone;
  };
  struct Triangle {
    std::uint32_t surface, number;
    auto operator<=>(const Triangle&) const = default;
  };

  struct InstanceBox {
    std::uint32_t instance;
    RTCBounds box;
  };

  /// Not what moves.
  static bool can_hold(const Shape& shape);
  static bool can_hold(const PlacedInstance& instance) { return instance.time_steps() == 1; }
  /// Of the shapes with these numbers, and of instances; not of nothing. std::runtime_error where
  /// it can't be built, and soon after a stop is requested.
  Tree(RTCDevice device, std::span<const Shape> shapes, std::span<const std::uint32_t> surfaces,
       std::span<const InstanceBox> instances, std::stop_token stop);

  const Block& block(Reference to) const { return blocks[to >> 2]; }
  static Corners corners(const Triangles& leaf, std::size_t i) {
    const auto at = [&](std::size_t k) {
      const std::size_t c = leaf.corner[k][i];
      return Vec3{leaf.coordinates[0][c], leaf.coordinates[1][c], leaf.coordinates[2][c]};
    };
    return {at(0), at(1), at(2)};
  }

  std::vector<Block, LargePages<Block>> blocks;
  std::vector<Triangle, LargePages<Triangle>> triangles;
  Reference root = 0;
  /// Of everything.
  Vec3 low, high;
};

}  // namespace nocturne

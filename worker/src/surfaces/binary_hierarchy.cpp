#include "surfaces/binary_hierarchy.h"

#include <algorithm>
#include <cstddef>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace nocturne {
namespace {

constexpr std::size_t kWidth = Tree::kWidth;

Box box_of(const RTCBuildPrimitive& p) {
  return {{p.lower_x, p.lower_y, p.lower_z}, {p.upper_x, p.upper_y, p.upper_z}};
}

float half_area(const Box& box) {
  const Vec3 size = box.high - box.low;
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

bool is_alone(const RTCBuildPrimitive& p) { return p.primID >= Binary::kInstance; }

Binary* new_binary(RTCThreadLocalAllocator allocator) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(Binary), alignof(Binary))) Binary;
}

Binary* joined(RTCThreadLocalAllocator allocator, Binary* a, Binary* b) {
  Binary* node = new_binary(allocator);
  node->is_leaf = false;
  node->child = {a, b};
  return node;
}

// Of as many as a leaf may hold; halves of them where they have too many corners, and until balls
// and instances are alone.
Binary* leaf_of(RTCThreadLocalAllocator allocator, const Meshes& meshes,
                std::span<RTCBuildPrimitive> all) {
  std::array<Tree::Triangle, kWidth> held;
  for (std::size_t i = 0; i < all.size(); ++i) held[i] = {all[i].geomID, all[i].primID};
  const bool has_alone = std::any_of(all.begin(), all.end(), is_alone);
  if (all.size() > 1 && (has_alone || !meshes.fit(std::span(held).first(all.size())))) {
    Box middles;
    const auto middle = [](const RTCBuildPrimitive& p) { return box_of(p).low + box_of(p).high; };
    for (const RTCBuildPrimitive& p : all) middles.add(middle(p));
    const Vec3 size = middles.high - middles.low;
    const auto along = [&](const RTCBuildPrimitive& p) {
      const Vec3 m = middle(p);
      if (size.x >= std::max(size.y, size.z)) return m.x;
      return size.y >= size.z ? m.y : m.z;
    };
    std::sort(all.begin(), all.end(),
              [&](const auto& a, const auto& b) { return along(a) < along(b); });
    const std::size_t half = all.size() / 2;
    Binary* first = leaf_of(allocator, meshes, all.first(half));
    return joined(allocator, first, leaf_of(allocator, meshes, all.subspan(half)));
  }
  Binary* leaf = new_binary(allocator);
  for (const RTCBuildPrimitive& p : all) leaf->box.add(box_of(p));
  leaf->triangles = has_alone ? 0 : static_cast<std::uint32_t>(all.size());
  leaf->held = held;
  return leaf;
}

// Two leaves that one can hold.
void merge(Binary& b, const Meshes& meshes) {
  const Binary &first = *b.child[0], &second = *b.child[1];
  if (!first.is_leaf || !second.is_leaf || first.triangles == 0 || second.triangles == 0) return;
  if (b.triangles > kWidth) return;
  auto end = std::copy_n(first.held.begin(), first.triangles, b.held.begin());
  std::copy_n(second.held.begin(), second.triangles, end);
  b.is_leaf = meshes.fit(std::span(b.held).first(b.triangles));
}

// Boxes, and by dynamic programming how many children of one node each is best made into: a node
// and a leaf cost the same, times how likely they are to be met, which goes by the area of their
// boxes.
void weigh(Binary& b, const Meshes& meshes) {
  b.split.fill(0);
  if (!b.is_leaf) {
    for (Binary* child : b.child) {
      weigh(*child, meshes);
      b.box.add(child->box);
      b.triangles += child->triangles;
    }
    b.cost.fill(Box::kInfinite);
    for (std::size_t k = 1; k < kWidth; ++k) {
      for (std::size_t first = 1; first <= k; ++first) {
        const float cost = b.child[0]->cost[first - 1] + b.child[1]->cost[k - first];
        if (!(cost < b.cost[k])) continue;
        b.cost[k] = cost;
        b.split[k] = static_cast<std::uint8_t>(first);
      }
    }
    b.cost[0] = b.cost[kWidth - 1] + half_area(b.box);
    merge(b, meshes);
  }
  if (b.is_leaf) b.cost[0] = half_area(b.box);
  for (std::size_t k = 1; k < kWidth; ++k) {
    // As many as the node has must stay as they are: it may not stand for itself.
    if (b.is_leaf || (k + 1 < kWidth && !(b.cost[k] < b.cost[k - 1]))) {
      b.cost[k] = b.cost[k - 1];
      if (k + 1 < kWidth) b.split[k] = b.split[k - 1];
    }
  }
}

}  // namespace

bool Meshes::fit(std::span<const Tree::Triangle> all) const {
  if (all.size() > Tree::kWidth) return false;
  std::array<Vec3, Tree::kWidth> seen;
  std::size_t count = 0;
  for (const Tree::Triangle& triangle : all) {
    for (const Vec3 p : corners(triangle)) {
      const auto end = seen.begin() + static_cast<std::ptrdiff_t>(count);
      if (std::find(seen.begin(), end, p) != end) continue;
      if (count == Tree::kWidth) return false;
      seen[count++] = p;
    }
  }
  return true;
}

BinaryHierarchy::BinaryHierarchy(RTCDevice device, const Meshes& meshes,
                                 std::vector<RTCBuildPrimitive>& primitives, std::stop_token stop)
    : meshes_(meshes), stop_(std::move(stop)), hierarchy_(rtcNewBVH(device)) {
  RTCBuildArguments to = rtcDefaultBuildArguments();
  to.maxBranchingFactor = 2;
  // A set of shapes that is to become a leaf is halved three times at most.
  to.maxDepth = Tree::kMaxDepth - 4;
  to.sahBlockSize = kWidth;
  to.maxLeafSize = kWidth;
  to.bvh = hierarchy_;
  to.primitives = primitives.data();
  to.primitiveCount = to.primitiveArrayCapacity = primitives.size();
  to.userPtr = this;
  to.createNode = [](RTCThreadLocalAllocator allocator, unsigned, void* self) -> void* {
    // What Embree asks about its progress it does not listen to; it catches exceptions.
    if (static_cast<BinaryHierarchy*>(self)->stop_.stop_requested()) {
      throw std::runtime_error("stopped");
    }
    return joined(allocator, nullptr, nullptr);
  };
  to.setNodeChildren = [](void* node, void** children, unsigned, void*) {
    static_cast<Binary*>(node)->child = {static_cast<Binary*>(children[0]),
                                         static_cast<Binary*>(children[1])};
  };
  to.setNodeBounds = [](void*, const RTCBounds**, unsigned, void*) {};  // by `weigh`
  to.createLeaf = [](RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* all,
                     std::size_t count, void* self) -> void* {
    std::array<RTCBuildPrimitive, kWidth> held;
    std::copy_n(all, count, held.begin());
    return leaf_of(allocator, static_cast<BinaryHierarchy*>(self)->meshes_,
                   std::span(held).first(count));
  };
  top_ = static_cast<Binary*>(rtcBuildBVH(&to));
  if (top_ == nullptr) {
    const RTCError error = rtcGetDeviceError(device);
    rtcReleaseBVH(hierarchy_);
    throw std::runtime_error("Embree can't build the scene: error " +
                             std::to_string(static_cast<int>(error)));
  }
  weigh(*top_, meshes);
}
}  // namespace nocturne

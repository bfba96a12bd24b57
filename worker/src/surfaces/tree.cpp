#include "surfaces/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "surfaces/embree_callbacks.h"

namespace nocturne {
namespace {

constexpr std::size_t kWidth = Tree::kWidth;
constexpr float kInfinite = std::numeric_limits<float>::infinity();
// To Embree's builder: a shape that is no mesh.
constexpr std::uint32_t kNoMesh = ~0u;

struct Box {
  Vec3 low{kInfinite, kInfinite, kInfinite}, high{-kInfinite, -kInfinite, -kInfinite};

  void add(Vec3 p, Vec3 q) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
  }
  void add(const Box& box) { add(box.low, box.high); }
  float half_area() const {
    const Vec3 size = high - low;
    return size.x * size.y + size.y * size.z + size.z * size.x;
  }
};

Box box_of(const RTCBuildPrimitive& p) {
  return {{p.lower_x, p.lower_y, p.lower_z}, {p.upper_x, p.upper_y, p.upper_z}};
}

bool is_ball(const RTCBuildPrimitive& p) { return p.primID == kNoMesh; }

// A node of the binary hierarchy that is made first, or a leaf of it.
struct Binary {
  Box box;
  std::uint32_t triangles = 0;  // below; none: a ball
  bool is_leaf = true;
  // cost[k]: of everything below as at most k + 1 children of one node; split[k]: how many of those
  // are the first child's, 0 where it is itself one of them.
  std::array<float, kWidth> cost;
  std::array<std::uint8_t, kWidth> split;
  std::array<Binary*, 2> child;
  std::array<Tree::Triangle, kWidth> held;
};

// What leaves are made of.
class Meshes {
 public:
  explicit Meshes(std::span<const Shape> shapes) : shapes_(shapes) {}

  std::array<Vec3, 3> corners(Tree::Triangle of) const {
    const auto& mesh = std::get<TriangleMesh>(shapes_[of.surface]);
    const auto& t = mesh.triangles[of.number];
    return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
  }
  // Whether they have no more corners than a leaf, those at one place counted once.
  bool fit(std::span<const Tree::Triangle> all) const {
    if (all.size() > kWidth) return false;
    std::array<Vec3, kWidth> seen;
    std::size_t count = 0;
    for (const Tree::Triangle& triangle : all) {
      for (const Vec3 p : corners(triangle)) {
        const auto end = seen.begin() + static_cast<std::ptrdiff_t>(count);
        if (std::find(seen.begin(), end, p) != end) continue;
        if (count == kWidth) return false;
        seen[count++] = p;
      }
    }
    return true;
  }

 private:
  std::span<const Shape> shapes_;
};

Binary* new_binary(RTCThreadLocalAllocator allocator) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(Binary), alignof(Binary))) Binary;
}

Binary* joined(RTCThreadLocalAllocator allocator, Binary* a, Binary* b) {
  Binary* node = new_binary(allocator);
  node->is_leaf = false;
  node->child = {a, b};
  return node;
}

// Of as many as a leaf may hold; halves of them where they have too many corners, and until a ball
// is alone.
Binary* leaf_of(RTCThreadLocalAllocator allocator, const Meshes& meshes,
                std::span<RTCBuildPrimitive> all) {
  std::array<Tree::Triangle, kWidth> held;
  for (std::size_t i = 0; i < all.size(); ++i) held[i] = {all[i].geomID, all[i].primID};
  const bool has_ball = std::any_of(all.begin(), all.end(), is_ball);
  if (all.size() > 1 && (has_ball || !meshes.fit(std::span(held).first(all.size())))) {
    Box middles;
    const auto middle = [](const RTCBuildPrimitive& p) { return box_of(p).low + box_of(p).high; };
    for (const RTCBuildPrimitive& p : all) middles.add(middle(p), middle(p));
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
  leaf->triangles = has_ball ? 0 : static_cast<std::uint32_t>(all.size());
  leaf->held = held;
  return leaf;
}

// The binary hierarchy, by Embree's builder (surface area heuristic, binned).
class BinaryBuild {
 public:
  BinaryBuild(RTCDevice device, const Meshes& meshes, std::vector<RTCBuildPrimitive>& primitives,
              std::stop_token stop)
      : meshes_(meshes), stop_(std::move(stop)), hierarchy_(rtcNewBVH(device)) {
    RTCBuildArguments to = rtcDefaultBuildArguments();
    to.maxBranchingFactor = 2;
    // What is to be a leaf is halved three times at most.
    to.maxDepth = Tree::kMaxDepth - 4;
    to.sahBlockSize = kWidth;
    to.maxLeafSize = kWidth;
    to.bvh = hierarchy_;
    to.primitives = primitives.data();
    to.primitiveCount = to.primitiveArrayCapacity = primitives.size();
    to.userPtr = this;
    to.createNode = [](RTCThreadLocalAllocator allocator, unsigned, void* self) -> void* {
      // What Embree asks about its progress it does not listen to; it catches what is thrown.
      if (static_cast<BinaryBuild*>(self)->stop_.stop_requested()) {
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
      return leaf_of(allocator, static_cast<BinaryBuild*>(self)->meshes_,
                     std::span(held).first(count));
    };
    top_ = static_cast<Binary*>(rtcBuildBVH(&to));
    if (top_ == nullptr) {
      const RTCError error = rtcGetDeviceError(device);
      rtcReleaseBVH(hierarchy_);
      throw std::runtime_error("Embree can't build the scene: error " +
                               std::to_string(static_cast<int>(error)));
    }
    weigh(*top_);
  }
  ~BinaryBuild() { rtcReleaseBVH(hierarchy_); }
  BinaryBuild(const BinaryBuild&) = delete;
  BinaryBuild& operator=(const BinaryBuild&) = delete;

  const Binary& top() const { return *top_; }

 private:
  // Boxes, and by dynamic programming how many children of one node each is best made into: a node
  // and a leaf cost the same, times how likely they are to be met, which goes by the area of their
  // boxes.
  void weigh(Binary& b) const {
    b.split.fill(0);
    if (!b.is_leaf) {
      for (Binary* child : b.child) {
        weigh(*child);
        b.box.add(child->box);
        b.triangles += child->triangles;
      }
      b.cost.fill(kInfinite);
      for (std::size_t k = 1; k < kWidth; ++k) {
        for (std::size_t first = 1; first <= k; ++first) {
          const float cost = b.child[0]->cost[first - 1] + b.child[1]->cost[k - first];
          if (!(cost < b.cost[k])) continue;
          b.cost[k] = cost;
          b.split[k] = static_cast<std::uint8_t>(first);
        }
      }
      b.cost[0] = b.cost[kWidth - 1] + b.box.half_area();
      merge(b);
    }
    if (b.is_leaf) b.cost[0] = b.box.half_area();
    for (std::size_t k = 1; k < kWidth; ++k) {
      // As many as the node has must stay as they are: it may not stand for itself.
      if (b.is_leaf || (k + 1 < kWidth && !(b.cost[k] < b.cost[k - 1]))) {
        b.cost[k] = b.cost[k - 1];
        if (k + 1 < kWidth) b.split[k] = b.split[k - 1];
      }
    }
  }
  // Two leaves that one can hold.
  void merge(Binary& b) const {
    const Binary &first = *b.child[0], &second = *b.child[1];
    if (!first.is_leaf || !second.is_leaf || first.triangles == 0 || second.triangles == 0) return;
    if (b.triangles > kWidth) return;
    auto end = std::copy_n(first.held.begin(), first.triangles, b.held.begin());
    std::copy_n(second.held.begin(), second.triangles, end);
    b.is_leaf = meshes_.fit(std::span(b.held).first(b.triangles));
  }

  const Meshes& meshes_;
  std::stop_token stop_;
  RTCBVH hierarchy_;
  Binary* top_;
};

// A bound in units of 1 / 255 of the node.
std::uint8_t as_byte(double units) {
  return static_cast<std::uint8_t>(std::clamp(units, 0.0, 255.0));
}

class Placing {
 public:
  Placing(Tree& tree, const Meshes& meshes) : tree_(tree), meshes_(meshes) {}

  Tree::Reference place(const Binary& b, std::size_t at) {
    if (!b.is_leaf) return place_node(b, at);
    if (b.triangles > 0) return place_triangles(b, at);
    tree_.blocks[at].ball = {b.held[0].surface};
    return Tree::reference(at, Tree::Kind::kBall);
  }

 private:
  struct Children {
    std::array<const Binary*, kWidth> all;
    std::size_t count = 0;
  };
  // As weighed: at most k + 1 of what is below.
  static void collect(const Binary& b, std::size_t k, Children& into) {
    if (b.is_leaf || b.split[k] == 0) {
      into.all[into.count++] = &b;
    } else {
      collect_below(b, k, into);
    }
  }
  static void collect_below(const Binary& b, std::size_t k, Children& into) {
    const std::size_t first = b.split[k];
    collect(*b.child[0], first - 1, into);
    collect(*b.child[1], k - first, into);
  }

  Tree::Reference place_node(const Binary& b, std::size_t at) {
    Children children;
    collect_below(b, kWidth - 1, children);
    const std::size_t first = tree_.blocks.size();
    if (first + children.count > Tree::kMaxBlocks) {
      throw std::runtime_error("the scene has more triangles than fit into a tree");
    }
    tree_.blocks.resize(first + children.count);
    Tree::Node node{};
    std::fill_n(node.child, kWidth, Tree::reference(0, Tree::Kind::kTriangles));
    const float low[3]{b.box.low.x, b.box.low.y, b.box.low.z};
    const float high[3]{b.box.high.x, b.box.high.y, b.box.high.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double extent = static_cast<double>(high[axis]) - static_cast<double>(low[axis]);
      float scale = std::max(static_cast<float>(extent / 255.0), 1e-30f);
      while (255.0 * static_cast<double>(scale) < extent) scale = std::nextafter(scale, kInfinite);
      node.base[axis] = low[axis];
      node.scale[axis] = scale;
      std::fill_n(node.plane[axis], kWidth, std::uint8_t{255});
    }
    for (std::size_t i = 0; i < children.count; ++i) {
      const Box& box = children.all[i]->box;
      const float from[3]{box.low.x, box.low.y, box.low.z};
      const float to[3]{box.high.x, box.high.y, box.high.z};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto units = [&](float v) {
          return (static_cast<double>(v) - static_cast<double>(node.base[axis])) /
                 static_cast<double>(node.scale[axis]);
        };
        node.plane[axis][i] = as_byte(std::floor(units(from[axis])));
        node.plane[3 + axis][i] = as_byte(std::ceil(units(to[axis])));
      }
      node.child[i] = place(*children.all[i], first + i);
    }
    tree_.blocks[at].node = node;
    return Tree::reference(at, Tree::Kind::kNode);
  }

  Tree::Reference place_triangles(const Binary& b, std::size_t at) {
    Tree::Triangles leaf{};
    leaf.first = static_cast<std::uint32_t>(tree_.triangles.size());
    // In order: of two that are met at once the first counts.
    std::array<Tree::Triangle, kWidth> held = b.held;
    std::sort(held.begin(), held.begin() + b.triangles);
    std::array<Vec3, kWidth> corners;
    std::size_t count = 0;
    for (std::size_t i = 0; i < b.triangles; ++i) {
      tree_.triangles.push_back(held[i]);
      const auto own = meshes_.corners(held[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto end = corners.begin() + static_cast<std::ptrdiff_t>(count);
        const auto found = std::find(corners.begin(), end, own[k]);
        leaf.corner[k][i] = static_cast<std::uint8_t>(found - corners.begin());
        if (found == end) corners[count++] = own[k];
      }
    }
    for (std::size_t i = 0; i < kWidth; ++i) {
      const Vec3 p = corners[i < count ? i : 0];
      leaf.coordinates[0][i] = p.x;
      leaf.coordinates[1][i] = p.y;
      leaf.coordinates[2][i] = p.z;
    }
    tree_.blocks[at].triangles = leaf;
    return Tree::reference(at, Tree::Kind::kTriangles);
  }

  Tree& tree_;
  const Meshes& meshes_;
};

void add_primitive(std::vector<RTCBuildPrimitive>& to, const Box& box, std::uint32_t surface,
                   std::uint32_t number) {
  to.push_back(
      {box.low.x, box.low.y, box.low.z, surface, box.high.x, box.high.y, box.high.z, number});
}

std::vector<RTCBuildPrimitive> primitives_of(std::span<const Shape> shapes,
                                             std::span<const std::uint32_t> surfaces) {
  std::size_t count = 0;
  for (const std::uint32_t surface : surfaces) {
    const auto* mesh = std::get_if<TriangleMesh>(&shapes[surface]);
    count += mesh != nullptr ? mesh->triangles.size() : 1;
  }
  std::vector<RTCBuildPrimitive> all;
  all.reserve(count);
  for (const std::uint32_t surface : surfaces) {
    if (const auto* sphere = std::get_if<Sphere>(&shapes[surface])) {
      const RTCBounds b = bounds_of(*sphere, 0);
      add_primitive(all, {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}},
                    surface, kNoMesh);
      continue;
    }
    const auto& mesh = std::get<TriangleMesh>(shapes[surface]);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      Box box;
      for (const std::uint32_t corner : mesh.triangles[i]) {
        box.add(mesh.vertices[corner], mesh.vertices[corner]);
      }
      add_primitive(all, box, surface, i);
    }
  }
  return all;
}

}  // namespace

bool Tree::can_hold(const Shape& shape) {
  const auto* mesh = std::get_if<TriangleMesh>(&shape);
  return mesh != nullptr ? mesh->time_steps == 1 : std::get<Sphere>(shape).later_centres.empty();
}

Tree::Tree(RTCDevice device, std::span<const Shape> shapes, std::span<const std::uint32_t> surfaces,
           std::stop_token stop) {
  const Meshes meshes(shapes);
  std::vector<RTCBuildPrimitive> primitives = primitives_of(shapes, surfaces);
  const BinaryBuild build(device, meshes, primitives, std::move(stop));
  primitives = {};
  low = build.top().box.low;
  high = build.top().box.high;
  // The first is the leaf of nothing.
  blocks.resize(2);
  blocks[0].triangles = {};
  root = Placing(*this, meshes).place(build.top(), 1);
  blocks.shrink_to_fit();
}

}  // namespace nocturne

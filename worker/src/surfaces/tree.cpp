#include "surfaces/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "surfaces/binary_hierarchy.h"
#include "surfaces/embree_callbacks.h"

namespace nocturne {
namespace {

constexpr std::size_t kWidth = Tree::kWidth;

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
    tree_.blocks[at].alone = {b.held[0].surface};
    return Tree::reference(
        at, b.held[0].number == Binary::kBall ? Tree::Kind::kBall : Tree::Kind::kInstance);
  }

 private:
  struct Children {
    std::array<const Binary*, kWidth> all;
    std::size_t count = 0;
  };
  // As weighed: at most k + 1 of the nodes below.
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
      while (255.0 * static_cast<double>(scale) < extent)
        scale = std::nextafter(scale, Box::kInfinite);
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

Box box_of(const RTCBounds& b) {
  return {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
}

void add_primitive(std::vector<RTCBuildPrimitive>& to, const Box& box, std::uint32_t surface,
                   std::uint32_t number) {
  to.push_back(
      {box.low.x, box.low.y, box.low.z, surface, box.high.x, box.high.y, box.high.z, number});
}

std::vector<RTCBuildPrimitive> primitives_of(std::span<const Shape> shapes,
                                             std::span<const std::uint32_t> surfaces,
                                             std::span<const Tree::InstanceBox> instances) {
  std::size_t count = instances.size();
  for (const std::uint32_t surface : surfaces) count += primitive_count(shapes[surface]);
  std::vector<RTCBuildPrimitive> all;
  all.reserve(count);
  for (const std::uint32_t surface : surfaces) {
    const auto add_mesh = [&](const TriangleMesh& mesh) {
      for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        Box box;
        for (const std::uint32_t corner : mesh.triangles[i]) box.add(mesh.vertices[corner]);
        add_primitive(all, box, surface, i);
      }
    };
    visit_shape(shapes[surface], add_mesh, [&](const Sphere& sphere) {
      add_primitive(all, box_of(bounds_of(sphere, 0)), surface, Binary::kBall);
    });
  }
  for (const auto& [instance, box] : instances) {
    add_primitive(all, box_of(box), instance, Binary::kInstance);
  }
  return all;
}

}  // namespace

bool Tree::can_hold(const Shape& shape) { return time_steps_of(shape) == 1; }

Tree::Tree(RTCDevice device, std::span<const Shape> shapes, std::span<const std::uint32_t> surfaces,
           std::span<const InstanceBox> instances, std::stop_token stop) {
  const Meshes meshes(shapes);
  std::vector<RTCBuildPrimitive> primitives = primitives_of(shapes, surfaces, instances);
  const BinaryHierarchy hierarchy(device, meshes, primitives, std::move(stop));
  primitives = {};
  low = hierarchy.top().box.low;
  high = hierarchy.top().box.high;
  // The first is the leaf of nothing.
  blocks.resize(2);
  blocks[0].triangles = {};
  root = Placing(*this, meshes).place(hierarchy.top(), 1);
  blocks.shrink_to_fit();
}

}  // namespace nocturne

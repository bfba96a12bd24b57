// Chooses between many elements by what they may contribute at a point: a binary tree whose nodes
// bound position, normals and power of what is below them, walked from the root to a leaf by the
// two children's importance. Conty Estevez and Kulla, "Importance sampling of many lights with
// adaptive tree splitting", Proc. ACM Comput. Graph. Interact. Tech. 1(2), 2018; importance with
// cosines instead of angles as in Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th
// ed., 12.6.3.
//
// Nodes lie in preorder, so that the same tree finds the elements on a half-line without a stack.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "luminaires/elements.h"
#include "luminaires/light_sampling_context.h"
#include "math/constants.h"
#include "math/functions.h"

namespace nocturne {

class LightTree {
 public:
  /// How an element is weighed: by its estimated irradiance, or by its weight alone wherever it is
  /// not wholly below the horizon.
  enum class Choice { kIrradiance, kWeight };

  LightTree(const Elements& elements, Choice choice);

  struct Chosen {
    std::uint32_t element;
    /// The uniform number, stretched to be used again.
    float choice;
  };
  /// Empty where no element can be seen.
  std::optional<Chosen> choose(const LightSamplingContext& from, float choice) const {
    std::uint32_t i = 0;
    while (!nodes_[i].leaf()) {
      const float left = importance(nodes_[i + 1], from);
      const float right = importance(nodes_[nodes_[i + 1].next], from);
      if (!(left + right > 0.0f)) return std::nullopt;
      const float p = left / (left + right);
      const bool go_left = choice < p;
      choice = go_left ? choice / p : (choice - p) / (1.0f - p);
      choice = std::min(choice, kOneMinusEpsilon);
      i = go_left ? i + 1 : nodes_[i + 1].next;
    }
    return Chosen{nodes_[i].element, choice};
  }

  /// The probability that `choose` gives this element.
  float probability(const LightSamplingContext& from, std::uint32_t element) const {
    float p = 1.0f;
    for (std::uint32_t i = leaf_of_[element]; i != 0; i = nodes_[i].parent) {
      const std::uint32_t parent = nodes_[i].parent;
      const std::uint32_t sibling = i == parent + 1 ? nodes_[i].next : parent + 1;
      const float here = importance(nodes_[i], from);
      if (!(here > 0.0f)) return 0.0f;
      p *= here / (here + importance(nodes_[sibling], from));
    }
    return p;
  }

  /// Calls visit(element) for all whose box the half-line meets.
  template <class Visit>
  void for_each_on(Vec3 origin, Vec3 direction, const Visit& visit) const {
    const Vec3 inverse{1.0f / direction.x, 1.0f / direction.y, 1.0f / direction.z};
    const auto count = static_cast<std::uint32_t>(nodes_.size());
    for (std::uint32_t i = 0; i < count;) {
      const Node& node = nodes_[i];
      if (!meets(node, origin, inverse)) {
        i = node.next;
        continue;
      }
      if (node.leaf()) visit(node.element);
      ++i;
    }
  }

 private:
  static constexpr std::uint32_t kInner = ~0u;

  struct Node {
    Vec3 low, high, axis;
    float cos_spread, sin_spread, weight, cosine_power;
    std::uint32_t next, parent;  // next: behind all that is below this node
    std::uint32_t element;       // kInner: none
    bool two_sided;

    bool leaf() const { return element != kInner; }
  };

  // The cosine of max(0, a - b), for angles in [0, pi].
  static float cos_less(float cos_a, float sin_a, float cos_b, float sin_b) {
    return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
  }
  static float sine(float cosine) { return std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)); }

  // Slabs (Kay and Kajiya 1986). A half-line within a slab's plane gives NaN, which fmin and fmax
  // leave out.
  static bool meets(const Node& n, Vec3 o, Vec3 inverse) {
    const float x0 = (n.low.x - o.x) * inverse.x, x1 = (n.high.x - o.x) * inverse.x;
    const float y0 = (n.low.y - o.y) * inverse.y, y1 = (n.high.y - o.y) * inverse.y;
    const float z0 = (n.low.z - o.z) * inverse.z, z1 = (n.high.z - o.z) * inverse.z;
    const float near = std::fmax(std::fmax(std::fmin(x0, x1), std::fmin(y0, y1)),
                                 std::fmax(std::fmin(z0, z1), 0.0f));
    const float far = std::fmin(std::fmin(std::fmax(x0, x1), std::fmax(y0, y1)), std::fmax(z0, z1));
    // Three rounding errors on each side (Ize, "Robust BVH ray traversal", JCGT 2(2), 2013).
    return near <= far * (1.0f + 4.0f * std::numeric_limits<float>::epsilon());
  }

  // An upper bound of the cosines over the distance squared (to the middle), times the weight. Zero
  // only where nothing below can shine on the receiver.
  float importance(const Node& node, const LightSamplingContext& from) const {
    const Vec3 half = 0.5f * (node.high - node.low);
    const Vec3 to = node.low + half - from.position;
    const float radius2 = dot(half, half), distance2 = dot(to, to);
    // The ball around the box: from inside anything may be in any direction.
    if (!(distance2 > radius2 * 1.0001f)) return node.weight / near_distance2(radius2);
    const float sin2 = radius2 / distance2;
    const float sin_ball = std::sqrt(sin2), cos_ball = std::sqrt(1.0f - sin2);
    const float inverse = 1.0f / std::sqrt(distance2);

    float cos_here = inverse * dot(from.normal, to);
    if (from.both_sides) cos_here = std::fabs(cos_here);
    const float receiver = cos_less(cos_here, sine(cos_here), cos_ball, sin_ball);
    if (receiver < -kRounding) return 0.0f;
    if (choice_ == Choice::kWeight) return node.weight;

    float cos_there = -inverse * dot(node.axis, to);
    if (node.two_sided) cos_there = std::fabs(cos_there);
    const float sin_there = sine(cos_there);
    const float from_cone = cos_less(cos_there, sin_there, node.cos_spread, node.sin_spread);
    const float emitter = cos_less(from_cone, sine(from_cone), cos_ball, sin_ball);
    if (emitter < -kRounding) return 0.0f;
    const float falloff = emission(std::max(emitter, kRounding), node.cosine_power);
    return node.weight * std::max(receiver, kRounding) * falloff / distance2;
  }

  static float emission(float cosine, float power) {
    if (power == 0.0f) return cosine;
    // Where a narrow lobe has faded away there is still something.
    return std::max(math::pow(cosine, power + 1.0f), 1e-6f);
  }

  // Never zero: an element may be a point for float.
  float near_distance2(float radius2) const {
    return choice_ == Choice::kWeight ? 1.0f : std::max(radius2, 1e-30f);
  }

  // Cosines are right to about 1e-6.
  static constexpr float kRounding = 1e-5f;

  friend class LightTreeBuilder;

  Choice choice_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_of_;
};

}  // namespace nocturne

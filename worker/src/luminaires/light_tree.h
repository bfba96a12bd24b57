// Chooses between many elements by their possible contribution at a point: a binary tree whose
// nodes bound position, normals and power of the elements below them, walked from the root to a
// leaf by the two children's importance. Conty Estevez and Kulla, "Importance sampling of many
// lights with adaptive tree splitting", Proc. ACM Comput. Graph. Interact. Tech. 1(2), 2018;
// importance with cosines instead of angles as in Pharr, Jakob and Humphreys, "Physically Based
// Rendering", 4th ed., 12.6.3.
//
// What chooses lies by inner nodes, each with its two children side by side, as both are looked at
// together. What finds elements on a half-line are boxes in preorder, which needs no stack.
#pragma once

#include <algorithm>
#include <array>
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
    float probability;
  };
  /// Empty where no element can be seen.
  std::optional<Chosen> choose(const LightSamplingContext& from, float choice) const {
    Below at = root_;
    float probability = 1.0f;
    while (!at.is_element) {
      const Children& children = children_[at.index];
      const Pair shares = importance(children, from);
      if (!(shares[0] + shares[1] > 0.0f)) return std::nullopt;
      const float p = shares[0] / (shares[0] + shares[1]);
      const bool go_left = choice < p;
      choice = go_left ? choice / p : (choice - p) / (1.0f - p);
      choice = std::min(choice, kOneMinusEpsilon);
      probability *= go_left ? p : 1.0f - p;
      at = children.below[go_left ? 0 : 1];
    }
    return Chosen{at.index, choice, probability};
  }

  /// The probability that `choose` gives this element.
  float probability(const LightSamplingContext& from, std::uint32_t element) const {
    float p = 1.0f;
    for (Above at = above_element_[element]; at.children != kNone;
         at = children_[at.children].above) {
      const Pair shares = importance(children_[at.children], from);
      const float here = shares[at.side];
      if (!(here > 0.0f)) return 0.0f;
      p *= here / (here + shares[1 - at.side]);
    }
    return p;
  }

  /// Calls visit(element) for all whose box the half-line meets.
  template <class Visit>
  void for_each_on(Vec3 origin, Vec3 direction, const Visit& visit) const {
    const Vec3 inverse{1.0f / direction.x, 1.0f / direction.y, 1.0f / direction.z};
    const auto count = static_cast<std::uint32_t>(boxes_.size());
    for (std::uint32_t i = 0; i < count;) {
      const Node& box = boxes_[i];
      if (!meets(box, origin, inverse)) {
        i = box.next;
        continue;
      }
      if (box.element != kNone) visit(box.element);
      ++i;
    }
  }

 private:
  static constexpr std::uint32_t kNone = ~0u;

  struct Node : Box {
    std::uint32_t next;     // behind all that is below
    std::uint32_t element;  // kNone: an inner node's
  };

  // Of an element, or of a node's children.
  struct Below {
    std::uint32_t index = 0;
    bool is_element = false;
  };
  // Where a node is among its parent's children; kNone: it is the root.
  struct Above {
    std::uint32_t children = kNone, side = 0;
  };

  // A number for each of two children: one register.
  using Pair [[gnu::vector_size(8)]] = float;

  struct Children {
    Pair x, y, z, radius2;  // the ball around the box
    Pair axis_x, axis_y, axis_z;
    Pair cos_spread, sin_spread, weight, cosine_power;
    std::array<bool, 2> two_sided;
    std::array<Below, 2> below;
    Above above;
  };

  static Pair maximum(Pair a, Pair b) { return a < b ? b : a; }
  static Pair absolute(Pair a) { return Pair{std::fabs(a[0]), std::fabs(a[1])}; }
  static Pair root(Pair a) { return Pair{std::sqrt(a[0]), std::sqrt(a[1])}; }

  // The cosine of max(0, a - b), for angles in [0, pi].
  static Pair cos_less(Pair cos_a, Pair sin_a, Pair cos_b, Pair sin_b) {
    const Pair one = {1.0f, 1.0f};
    return cos_a > cos_b ? one : cos_a * cos_b + sin_a * sin_b;
  }
  static Pair sine(Pair cosine) { return root(maximum(Pair{}, 1.0f - cosine * cosine)); }

  // Slabs (Kay and Kajiya 1986). A half-line within a slab's plane gives NaN, which fmin and fmax
  // leave out.
  static bool meets(const Box& n, Vec3 o, Vec3 inverse) {
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
  Pair importance(const Children& c, const LightSamplingContext& from) const {
    const Pair x = c.x - from.position.x, y = c.y - from.position.y, z = c.z - from.position.z;
    const Pair distance2 = x * x + y * y + z * z;
    // The ball around the box: from inside anything may be in any direction.
    const auto outside = distance2 > c.radius2 * 1.0001f;
    const Pair inverse2 = 1.0f / distance2, inverse = root(inverse2);
    const Pair sin2 = c.radius2 * inverse2;
    const Pair sin_ball = root(sin2), cos_ball = root(1.0f - sin2);

    Pair cos_here = inverse * (from.normal.x * x + from.normal.y * y + from.normal.z * z);
    if (from.both_sides) cos_here = absolute(cos_here);
    const Pair receiver = cos_less(cos_here, sine(cos_here), cos_ball, sin_ball);
    const Pair none = {};
    if (choice_ == Choice::kWeight) {
      const Pair seen = receiver < -kRounding ? none : c.weight;
      return outside ? seen : c.weight;
    }

    Pair cos_there = -inverse * (c.axis_x * x + c.axis_y * y + c.axis_z * z);
    for (unsigned side = 0; side < 2; ++side) {
      if (c.two_sided[side]) cos_there[side] = std::fabs(cos_there[side]);
    }
    const Pair from_cone = cos_less(cos_there, sine(cos_there), c.cos_spread, c.sin_spread);
    const Pair emitter = cos_less(from_cone, sine(from_cone), cos_ball, sin_ball);
    const Pair least = {kRounding, kRounding}, nearest2 = {1e-30f, 1e-30f};
    const Pair falloff = emission(maximum(emitter, least), c.cosine_power);
    const Pair far = c.weight * maximum(receiver, least) * falloff * inverse2;
    const auto unseen = (receiver < -kRounding) | (emitter < -kRounding);
    const Pair seen = unseen ? none : far;
    // Never zero: an element may be a point for float.
    return outside ? seen : c.weight / maximum(c.radius2, nearest2);
  }

  static Pair emission(Pair cosine, Pair power) {
    for (unsigned side = 0; side < 2; ++side) {
      if (power[side] == 0.0f) continue;
      // Where a narrow lobe has faded away there is still something.
      cosine[side] = std::max(math::pow(cosine[side], power[side] + 1.0f), 1e-6f);
    }
    return cosine;
  }

  // Cosines are right to about 1e-6.
  static constexpr float kRounding = 1e-5f;

  friend class LightTreeBuilder;

  Choice choice_;
  Below root_;
  std::vector<Children> children_;
  std::vector<Above> above_element_;
  std::vector<Node> boxes_;
};

}  // namespace nocturne

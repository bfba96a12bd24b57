#include "luminaires/light_tree.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "math/functions.h"

namespace nocturne {
namespace {

constexpr double kPiD = std::numbers::pi;

double axis_of(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
// The smallest cone around two, Conty Estevez and Kulla 2018, algorithm 1.
void unite_cones(ElementBounds& a, const ElementBounds& b) {
  double wide = math::acos(std::clamp(a.cos_spread, -1.0f, 1.0f));
  double narrow = math::acos(std::clamp(b.cos_spread, -1.0f, 1.0f));
  Vec3 wide_axis = a.axis, narrow_axis = b.axis;
  if (narrow > wide) {
    std::swap(wide, narrow);
    std::swap(wide_axis, narrow_axis);
  }
  // Of two-sided elements either normal will do.
  if (a.two_sided && b.two_sided && dot(wide_axis, narrow_axis) < 0.0f) narrow_axis = -narrow_axis;
  const double apart = math::acos(std::clamp(dot(wide_axis, narrow_axis), -1.0f, 1.0f));
  a.axis = wide_axis;
  a.cos_spread = static_cast<float>(math::cos(wide));
  if (std::min(apart + narrow, kPiD) <= wide) return;
  const double spread = 0.5 * (wide + apart + narrow);
  const Vec3 across = narrow_axis - dot(wide_axis, narrow_axis) * wide_axis;
  if (spread >= kPiD || !(dot(across, across) > 1e-12f)) {
    a.cos_spread = spread >= kPiD || apart > 1.0 ? -1.0f : static_cast<float>(math::cos(spread));
    return;
  }
  const double turn = spread - wide;
  a.axis = normalized(static_cast<float>(math::cos(turn)) * wide_axis +
                      static_cast<float>(math::sin(turn)) * normalized(across));
  a.cos_spread = static_cast<float>(math::cos(spread));
}

ElementBounds unite(ElementBounds a, const ElementBounds& b) {
  a.add(b);
  unite_cones(a, b);
  a.two_sided = a.two_sided || b.two_sided;
  a.cosine_power = std::min(a.cosine_power, b.cosine_power);
  a.weight += b.weight;
  return a;
}

// Surface area x orientation x weight, equation 1 of the paper with theta_e = pi / 2.
double cost(const ElementBounds& b) {
  const Vec3 d = b.high - b.low;
  const double area = 2.0 * (static_cast<double>(d.x) * d.y + static_cast<double>(d.y) * d.z +
                             static_cast<double>(d.z) * d.x);
  const double spread = math::acos(std::clamp(b.cos_spread, -1.0f, 1.0f));
  const double wide = std::min(spread + 0.5 * kPiD, kPiD);
  const double s = math::sin(spread), c = math::cos(spread);
  const double solid =
      2.0 * kPiD * (1.0 - c) +
      0.5 * kPiD * (2.0 * wide * s - math::cos(spread - 2.0 * wide) - 2.0 * spread * s + c);
  // A row of lamps in a line has no area: its length still counts.
  const double length2 = static_cast<double>(dot(d, d));
  return b.weight * (b.two_sided ? 2.0 : 1.0) * solid * (area + 1e-4 * length2);
}

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0, bucket = 0;
};

}  // namespace

class LightTreeBuilder {
 public:
  LightTreeBuilder(LightTree& tree, const Elements& elements) : tree_(tree), elements_(elements) {
    order_.resize(elements.size());
    std::iota(order_.begin(), order_.end(), 0u);
    tree_.above_element_.resize(elements.size());
    if (order_.empty()) return;
    tree_.boxes_.reserve(2 * elements.size());
    tree_.children_.reserve(elements.size());
    tree_.root_ = build(0, order_.size(), {}, 0).below;
  }

 private:
  struct Built {
    ElementBounds bounds;
    LightTree::Below below;
  };

  static constexpr int kBuckets = 12;
  // Beyond this depth halves are taken, so that recursion ends soon whatever the scene.
  static constexpr int kDeepest = 48;

  Built build(std::size_t begin, std::size_t end, LightTree::Above above, int depth) {
    const std::size_t box = tree_.boxes_.size();
    ElementBounds bounds = elements_.bounds(order_[begin]);
    for (std::size_t i = begin + 1; i < end; ++i) {
      bounds = unite(bounds, elements_.bounds(order_[i]));
    }
    const bool is_element = end - begin == 1;
    tree_.boxes_.push_back(
        {{bounds.low, bounds.high}, 0, is_element ? order_[begin] : LightTree::kNone});
    LightTree::Below below{order_[begin], is_element};
    if (is_element) {
      tree_.above_element_[order_[begin]] = above;
    } else {
      below.index = static_cast<std::uint32_t>(tree_.children_.size());
      tree_.children_.emplace_back().above = above;
      const std::size_t middle_index = divide(begin, end, depth);
      put(build(begin, middle_index, {below.index, 0}, depth + 1), below.index, 0);
      put(build(middle_index, end, {below.index, 1}, depth + 1), below.index, 1);
    }
    tree_.boxes_[box].next = static_cast<std::uint32_t>(tree_.boxes_.size());
    return {bounds, below};
  }

  void put(const Built& child, std::uint32_t children, unsigned side) {
    LightTree::Children& c = tree_.children_[children];
    const ElementBounds& b = child.bounds;
    const Vec3 half = 0.5f * (b.high - b.low), at = b.low + half;
    const float cosine = std::clamp(b.cos_spread, -1.0f, 1.0f);
    c.x[side] = at.x;
    c.y[side] = at.y;
    c.z[side] = at.z;
    c.radius2[side] = dot(half, half);
    c.axis_x[side] = b.axis.x;
    c.axis_y[side] = b.axis.y;
    c.axis_z[side] = b.axis.z;
    c.cos_spread[side] = cosine;
    c.sin_spread[side] = std::sqrt(1.0f - cosine * cosine);
    c.weight[side] = static_cast<float>(b.weight);
    c.cosine_power[side] = b.cosine_power;
    c.two_sided[side] = b.two_sided;
    c.below[side] = child.below;
  }

  // Where the middles of the elements lie.
  struct Range {
    std::array<double, 3> low, high;
  };

  Range range_of(std::size_t begin, std::size_t end) const {
    Range r;
    r.low.fill(std::numeric_limits<double>::infinity());
    r.high.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 m = elements_.bounds(order_[i]).middle();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double x = axis_of(m, static_cast<int>(axis));
        r.low[axis] = std::min(r.low[axis], x);
        r.high[axis] = std::max(r.high[axis], x);
      }
    }
    return r;
  }

  static int bucket_of(const Range& r, int axis, Vec3 m) {
    const auto a = static_cast<std::size_t>(axis);
    const double t = (axis_of(m, axis) - r.low[a]) / (r.high[a] - r.low[a]);
    return std::min(kBuckets - 1, static_cast<int>(t * kBuckets));
  }

  // The best place to cut along one axis.
  Split best_split(std::size_t begin, std::size_t end, const Range& r, int axis) const {
    std::array<std::optional<ElementBounds>, kBuckets> buckets;
    for (std::size_t i = begin; i < end; ++i) {
      const ElementBounds& b = elements_.bounds(order_[i]);
      auto& bucket = buckets[static_cast<std::size_t>(bucket_of(r, axis, b.middle()))];
      bucket = bucket ? unite(*bucket, b) : b;
    }
    std::array<double, kBuckets> from_right{};
    std::optional<ElementBounds> sum;
    for (std::size_t i = kBuckets; i-- > 1;) {
      if (buckets[i]) sum = sum ? unite(*sum, *buckets[i]) : *buckets[i];
      from_right[i] = sum ? cost(*sum) : 0.0;
    }
    sum.reset();
    Split best;
    for (std::size_t i = 0; i + 1 < kBuckets; ++i) {
      if (buckets[i]) sum = sum ? unite(*sum, *buckets[i]) : *buckets[i];
      const double total = (sum ? cost(*sum) : 0.0) + from_right[i + 1];
      if (total < best.cost) best = {total, axis, static_cast<int>(i)};
    }
    return best;
  }

  std::size_t divide(std::size_t begin, std::size_t end, int depth) {
    const Range r = range_of(begin, end);
    const double longest =
        std::max({r.high[0] - r.low[0], r.high[1] - r.low[1], r.high[2] - r.low[2]});
    Split best;
    for (int axis = 0; axis < 3 && depth < kDeepest && end - begin > 2; ++axis) {
      const double extent =
          r.high[static_cast<std::size_t>(axis)] - r.low[static_cast<std::size_t>(axis)];
      if (!(extent > 0.0)) continue;
      Split split = best_split(begin, end, r, axis);
      split.cost *= longest / extent;  // against thin slices, as in the paper
      if (split.cost < best.cost) best = split;
    }
    const auto first = order_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = order_.begin() + static_cast<std::ptrdiff_t>(end);
    if (std::isfinite(best.cost)) {
      const auto cut = std::partition(first, last, [&](std::uint32_t element) {
        return bucket_of(r, best.axis, elements_.bounds(element).middle()) <= best.bucket;
      });
      if (cut != first && cut != last) return static_cast<std::size_t>(cut - order_.begin());
    }
    return begin + (end - begin) / 2;
  }

  LightTree& tree_;
  const Elements& elements_;
  std::vector<std::uint32_t> order_;
};

LightTree::LightTree(const Elements& elements, Choice choice) : choice_(choice) {
  LightTreeBuilder(*this, elements);
}

}  // namespace nocturne

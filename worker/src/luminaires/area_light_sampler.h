// The density over directions that points at elements of luminaires (or at declared important
// shapes): one is chosen by LightTree, then a direction to it. As the density of a direction adds
// up every element on the half-line, hidden ones too, it is exact whatever stands between: a lamp
// behind glass is no special case.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "luminaires/apart.h"
#include "luminaires/elements.h"
#include "luminaires/light_sampling_context.h"
#include "luminaires/light_tree.h"

namespace nocturne {

class AreaLightSampler {
 public:
  /// Luminaires: kIrradiance. Important shapes, whose weights are the user's: kWeight.
  explicit AreaLightSampler(Elements elements,
                            LightTree::Choice choice = LightTree::Choice::kIrradiance)
      : elements_(std::move(elements)),
        tree_(elements_, choice),
        apart_up_to_(elements_.size() <= kMaxTestedOneByOne
                         ? apart_up_to(elements_)
                         : std::vector<float>(elements_.size(), -1.0f)) {}

  bool empty() const { return elements_.size() == 0; }

  /// A unit direction; three uniform numbers. Empty where nothing is to be seen, where the drawn
  /// element has no extent from there, and where it is drawn below the receiver's horizon.
  std::optional<DrawnDirection> sample(const LightSamplingContext& from, float choice, float u1,
                                       float u2) const {
    if (empty()) return std::nullopt;
    const auto chosen = tree_.choose(from, choice);
    if (!chosen) return std::nullopt;
    auto drawn = elements_.sample(chosen->element, from, u1, u2);
    if (!drawn || !from.sees(drawn->direction)) return std::nullopt;
    drawn->pdf *= chosen->probability;
    return drawn;
  }

  /// Density of `sample`, 1/sr.
  float pdf(const LightSamplingContext& from, Vec3 direction) const {
    float sum = 0.0f;
    for_each_on(from, direction, [&](float pdf, float, std::size_t) { sum += pdf; });
    return sum;
  }

  /// The nearest element on a half-line.
  struct Nearest {
    /// Density of `sample`, which counts all elements there, 1/sr.
    float pdf = 0.0f;
    /// m; infinite where there is none.
    float distance = std::numeric_limits<float>::infinity();
    std::size_t element = 0;
    /// Where it is met.
    ElementPoint point{};
  };
  /// What a ray in `direction` finds.
  Nearest nearest(const LightSamplingContext& from, Vec3 direction) const {
    Nearest nearest;
    for_each_on(from, direction, [&](float pdf, float distance, std::size_t element) {
      add(nearest, from, direction, pdf, distance, element);
    });
    return nearest;
  }

  /// The direction that `sample` draws, and the nearest element on it.
  struct Drawn {
    Vec3 direction;
    Nearest nearest;
  };
  std::optional<Drawn> draw(const LightSamplingContext& from, float choice, float u1,
                            float u2) const {
    if (empty()) return std::nullopt;
    const auto chosen = tree_.choose(from, choice);
    if (!chosen) return std::nullopt;
    const auto drawn = elements_.draw(chosen->element, from, u1, u2);
    if (!drawn || !from.sees(drawn->direction)) return std::nullopt;
    if (!(drawn->distance <= apart_up_to_[chosen->element])) {
      return Drawn{drawn->direction, nearest(from, drawn->direction)};
    }
    Drawn found{drawn->direction,
                {.pdf = chosen->probability * drawn->pdf,
                 .distance = drawn->distance,
                 .element = chosen->element,
                 .point = drawn->point}};
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      if (i == chosen->element) continue;
      visit_on(from, drawn->direction, i, [&](float pdf, float distance, std::size_t element) {
        add(found.nearest, from, drawn->direction, pdf, distance, element);
      });
    }
    return found;
  }

  /// The parts, for what looks inside.
  const Elements& elements() const { return elements_; }
  const LightTree& tree() const { return tree_; }

 private:
  // One more element on the half-line.
  void add(Nearest& nearest, const LightSamplingContext& from, Vec3 direction, float pdf,
           float distance, std::size_t element) const {
    nearest.pdf += pdf;
    if (!(distance < nearest.distance)) return;
    nearest.distance = distance;
    nearest.element = element;
    nearest.point = elements_.point_at(element, from, direction, distance);
  }

  // f(density, distance, element) where the element is on the half-line.
  template <class F>
  void visit_on(const LightSamplingContext& from, Vec3 direction, std::size_t element,
                const F& f) const {
    const OnHalfLine there = elements_.along(element, from, direction);
    if (!(there.pdf > 0.0f)) return;
    f(there.pdf * tree_.probability(from, static_cast<std::uint32_t>(element)), there.distance,
      element);
  }

  // The same for all, hidden ones too.
  template <class F>
  void for_each_on(const LightSamplingContext& from, Vec3 direction, const F& f) const {
    if (!from.sees(direction)) return;
    const auto visit = [&](std::size_t i) { visit_on(from, direction, i, f); };
    if (elements_.size() <= kMaxTestedOneByOne) {
      for (std::size_t i = 0; i < elements_.size(); ++i) visit(i);
    } else {
      tree_.for_each_on(from.position, direction, visit);
    }
  }

  // Up to here testing each is cheaper than a walk through the tree (about 100 ns, against 4 ns for
  // an element).
  static constexpr std::size_t kMaxTestedOneByOne = 16;

  Elements elements_;
  LightTree tree_;
  std::vector<float> apart_up_to_;
};

}  // namespace nocturne

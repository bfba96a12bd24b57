// The density over directions that points at elements of luminaires (or at declared important
// shapes): one is chosen by LightTree, then a direction to it. As the density of a direction adds
// up every element on the half-line, hidden ones too, it is exact whatever stands between: a lamp
// behind glass is no special case.
#pragma once

#include <optional>
#include <utility>

#include "luminaires/elements.h"
#include "luminaires/light_sampling_context.h"
#include "luminaires/light_tree.h"

namespace nocturne {

class LuminaireDirections {
 public:
  /// Luminaires: kIrradiance. Important shapes, whose weights are the user's: kWeight.
  explicit LuminaireDirections(Elements elements,
                               LightTree::Choice choice = LightTree::Choice::kIrradiance)
      : elements_(std::move(elements)), tree_(elements_, choice) {}

  bool empty() const { return elements_.size() == 0; }

  /// A unit direction; three uniform numbers. Empty where nothing is to be seen, where the drawn
  /// element has no extent from there, and where it is drawn below the receiver's horizon.
  std::optional<Vec3> sample(const LightSamplingContext& from, float choice, float u1,
                             float u2) const {
    if (empty()) return std::nullopt;
    const auto chosen = tree_.choose(from, choice);
    if (!chosen) return std::nullopt;
    const auto direction = elements_.sample(chosen->element, from, u1, u2);
    if (!direction || !from.sees(*direction)) return std::nullopt;
    return direction;
  }

  /// Density of `sample`, 1/sr.
  float pdf(const LightSamplingContext& from, Vec3 direction) const {
    if (!from.sees(direction)) return 0.0f;
    float sum = 0.0f;
    const auto add = [&](std::size_t i) {
      const float pdf = elements_.pdf(i, from, direction);
      if (pdf > 0.0f) sum += pdf * tree_.probability(from, static_cast<std::uint32_t>(i));
    };
    if (elements_.size() <= kMaxTestedOneByOne) {
      for (std::size_t i = 0; i < elements_.size(); ++i) add(i);
    } else {
      tree_.for_each_on(from.position, direction, add);
    }
    return sum;
  }

  /// The parts, for what looks inside.
  const Elements& elements() const { return elements_; }
  const LightTree& tree() const { return tree_; }

 private:
  // Up to here testing each is cheaper than a walk through the tree (about 100 ns, against 4 ns for
  // an element).
  static constexpr std::size_t kMaxTestedOneByOne = 16;

  Elements elements_;
  LightTree tree_;
};

}  // namespace nocturne

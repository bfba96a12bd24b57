#include "tracer/pilot/rounds.h"

#include <algorithm>

namespace nocturne {
namespace {

/// Samples of a pixel in the first round, and how many times as many each round has as the one
/// before. By few samples, those from the sensor had 2 to 50 times the error that they have in a
/// render, where they fill all dimensions evenly, and those from luminaires 1 to 3 times.
constexpr std::uint32_t kFirstSamples = 16, kMoreSamples = 4;

}  // namespace

MethodFigures Rounds::best_of(const std::vector<PilotMethod>& methods) {
  std::vector<PilotMethod> left = methods;
  for (samples_ = kFirstSamples;; samples_ *= kMoreSamples) {
    std::vector<MethodFigures> figures = compared(left);
    std::ranges::stable_sort(figures, is_better);
    for (const MethodFigures& each : figures) {
      if (each.method == methods.front()) plainest_ = each, beside_plainest_ = figures.front();
    }
    if (samples_ * kMoreSamples > most_samples_) return figures.front();
    figures.resize((figures.size() + 1) / 2);
    left.clear();
    for (const MethodFigures& each : figures) left.push_back(each.method);
  }
}

std::vector<MethodFigures> Rounds::compared(const std::vector<PilotMethod>& methods) {
  auto figures = figures_of_methods(methods, images(), given_ratio_);
  for (const MethodFigures& each : figures) {
    if (each.method.sensor) tried_[each.sensor.kind] = each.sensor;
    if (each.method.luminaires) tried_[each.luminaires.kind] = each.luminaires;
  }
  return figures;
}

const PilotImages& Rounds::images_of(const PhotonKind& kind) {
  PilotImages& images = images_[kind];
  if (images.samples < samples_) {
    extend(images, trials_.images(kind, film_, whole(film_, samples_, images.samples)));
  }
  return images;
}

}  // namespace nocturne

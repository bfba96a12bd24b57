#include "tracer/pilot/pilot_method.h"

#include <set>

namespace nocturne {
namespace {

std::vector<PhotonKind> kinds_from_sensor(PhotonKind::From from, bool guide) {
  std::vector<PhotonKind> kinds{{.from = from}};
  if (guide) kinds.push_back({.from = from, .guided = true});
  return kinds;
}

std::vector<PhotonKind> kinds_from_luminaires(const OpenChoices& open,
                                              const TracingOptions& given) {
  std::vector<PhotonKind> kinds{{.from = PhotonKind::kLuminaires, .aimed = given.aimed_emission}};
  if (open.direction && open.aim && given.aimed_emission > 0.0f) {
    kinds.push_back({.from = PhotonKind::kLuminaires});
  }
  return kinds;
}

}  // namespace

std::vector<PilotMethod> methods_of(const OpenChoices& open, TracingOptions given,
                                    bool has_mirrors) {
  if (open.direction && given.direction != Direction::kForward && !has_mirrors) {
    given.direction = Direction::kAdjoint;
  }
  std::vector<PilotMethod> methods;
  if (!open.direction && given.direction == Direction::kForward) {
    return {{std::nullopt, kinds_from_luminaires(open, given).front()}};
  }
  const bool all_light = open.direction || given.direction == Direction::kAdjoint;
  const auto from = all_light ? PhotonKind::kSensor : PhotonKind::kSensorOfBoth;
  for (const PhotonKind& kind : kinds_from_sensor(from, open.guide)) {
    methods.push_back({kind, std::nullopt});
  }
  if (!open.direction || given.direction == Direction::kAdjoint) return methods;
  std::vector<PhotonKind> of_both;
  if (given.direction == Direction::kBoth) {
    of_both = kinds_from_sensor(PhotonKind::kSensorOfBoth, open.guide);
  }
  for (const PhotonKind& luminaires : kinds_from_luminaires(open, given)) {
    for (const PhotonKind& sensor : of_both) methods.push_back({sensor, luminaires});
    if (of_both.empty()) methods.push_back({std::nullopt, luminaires});
  }
  return methods;
}

std::vector<PhotonKind> kinds_of(const std::vector<PilotMethod>& methods) {
  std::set<PhotonKind> kinds;
  for (const auto& [sensor, luminaires] : methods) {
    if (sensor) kinds.insert(*sensor);
    if (luminaires) kinds.insert(*luminaires);
  }
  return {kinds.begin(), kinds.end()};
}

}  // namespace nocturne

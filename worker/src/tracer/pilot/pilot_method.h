// Methods of tracing that a pilot compares, each of photons of one kind or of two.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "scene/scene.h"

namespace nocturne {

/// Photons that start at one end of paths, and what helps them to the other.
struct PhotonKind {
  enum From : std::uint8_t {
    /// From the sensor, which bring all light.
    kSensor,
    /// From the sensor, which leave to photons from luminaires what these bring.
    kSensorOfBoth,
    kLuminaires,
  };
  From from = kSensor;
  /// From the sensor: sent to where light was learned to come from.
  bool guided = false;
  /// From luminaires: the part that is aimed at important shapes.
  float aimed = 0.0f;
  /// Pixels that share the light found by photons from the sensor.
  std::uint32_t sharing = 1;

  auto operator<=>(const PhotonKind&) const = default;
};

/// At least one of both.
struct PilotMethod {
  std::optional<PhotonKind> sensor, luminaires;

  bool operator==(const PilotMethod&) const = default;
};

/// What a scene leaves open; PilotRequest has the same in the words of who asks.
struct OpenChoices {
  bool direction, aim, guide;
};

/// All methods between which `open` leaves the choice, the plainest first. `given`: as the scene
/// was loaded. Without mirrors and glass photons from the sensor alone are compared.
std::vector<PilotMethod> methods_of(const OpenChoices& open, TracingOptions given,
                                    bool has_mirrors);

/// Each once.
std::vector<PhotonKind> kinds_of(const std::vector<PilotMethod>& methods);

}  // namespace nocturne

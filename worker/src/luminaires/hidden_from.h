// Whom a light is hidden from. It lights everything else the same.
#pragma once

namespace nocturne {

enum class HiddenFrom {
  kNobody,
  /// What the camera sees without anything in between that turns light: it sees past the light.
  kCamera,
  /// The same in mirrors and through clear glass, as long as nothing has scattered the light. Lamps
  /// without a size are so in other renderers, as no ray can meet them.
  kCameraAndMirrors,
};

}  // namespace nocturne

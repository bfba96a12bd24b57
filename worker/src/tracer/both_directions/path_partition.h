// Which photons bring a path of light where photons start at both ends
// (docs/decisions/0032-each-path-by-one-direction.md). An interaction is specular-like (a mirror,
// glass, or as good as one; the smooth coat of paint and a pane where they mirror) or diffuse-like
// (all others, media too). A path is a forward photon's if its interaction next to the luminaire is
// specular-like, or so near to it as a lamp's housing is, and another one, next to the camera, is
// diffuse-like and not near; all others are adjoint photons'. So both know from their own path
// which light is theirs: no weights, no densities of the other direction.
#pragma once

#include <cstdint>

#include "kernels/kernel.h"

namespace nocturne {

struct Interaction {
  /// By the kernel as a whole, whichever of its lobes was drawn.
  bool specular_like;
  /// A delta lobe was drawn.
  bool delta;
  /// On through a pane or a mask in the same direction: as if nothing were there.
  bool straight;
  /// So near to the camera that a forward photon would count by far too much there.
  bool near_camera;
  /// So near to the luminaire that an adjoint photon would come there by chance alone, over
  /// whatever surrounds both. It applies to forward photons.
  bool near_luminaire = false;

  constexpr bool as_if_nothing_were_there() const { return straight && !specular_like; }
  constexpr bool keeps_together() const { return specular_like || delta; }
};

/// The ends of a path, as far as the photon that walks it knows them.
struct PathEnds {
  /// At the luminaire that counts which is near, too.
  bool diffuse_like_at_camera = false, specular_like_at_luminaire = false;
};

/// The partition: which photons bring a path with these ends.
constexpr Transport owner_of(PathEnds ends) {
  return ends.diffuse_like_at_camera && ends.specular_like_at_luminaire ? Transport::kForward
                                                                        : Transport::kAdjoint;
}

/// An adjoint photon's ends after one more interaction; `first`: nothing was met before.
constexpr PathEnds after_adjoint(PathEnds ends, const Interaction& i, bool first) {
  if (first) ends.diffuse_like_at_camera = !i.delta && !i.specular_like && !i.near_camera;
  if (!i.as_if_nothing_were_there()) ends.specular_like_at_luminaire = i.keeps_together();
  return ends;
}

/// An adjoint photon's where it meets a luminaire after `interactions`, those not counted that let
/// it straight through; `near`: the latest was near to it.
constexpr PathEnds at_luminaire(PathEnds ends, std::uint32_t interactions, bool near) {
  if (near && interactions > 1) ends.specular_like_at_luminaire = true;
  return ends;
}

/// A forward photon's. Once it is specular-like at the luminaire it stays so.
constexpr PathEnds after_forward(PathEnds ends, const Interaction& i) {
  if (i.as_if_nothing_were_there()) return ends;
  if (i.keeps_together() || i.near_luminaire) ends.specular_like_at_luminaire = true;
  return ends;
}

/// Whether a forward photon may still bring something after its latest interaction.
constexpr bool forward_goes_on(PathEnds after, const Interaction& latest) {
  return after.specular_like_at_luminaire || latest.as_if_nothing_were_there();
}

}  // namespace nocturne

// In the place of worker/src/tracer/free_flight.h: a tracer that knows no media.
#pragma once

#include <limits>
#include <optional>

#include "scene/scene.h"
#include "tracer/group.h"

namespace nocturne {

template <int N>
class FreeFlight {
 public:
  FreeFlight(const Scene&, const Spectral<N>&) {}
  bool enter(const InteriorList&) { return false; }
  bool thin(const Group<N>&, float) { return false; }
  std::optional<Hit> collide(Group<N>&, float) const { return std::nullopt; }
  std::optional<Hit> force(Group<N>&, float) const { return std::nullopt; }
  void pass(Group<N>&, float) const {}
};

}  // namespace nocturne

// Where surfaces stand: once in the scene, or in each instance of their group.
#pragma once

#include <cstdint>

#include "surfaces/geometry.h"

namespace nocturne {

/// use(instance), null for a surface that stands in the scene itself.
template <class Use>
void for_each_place(const Geometry& geometry, std::uint32_t group, const Use& use) {
  if (group == 0) {
    use(nullptr);
    return;
  }
  for (const PlacedInstance& instance : geometry.instances()) {
    if (instance.group() == group) use(&instance);
  }
}

/// As in Hit.
inline std::uint32_t index_of(const Geometry& geometry, const PlacedInstance* instance) {
  return instance == nullptr ? Hit::kNoInstance
                             : static_cast<std::uint32_t>(instance - geometry.instances().data());
}

/// A point of a surface, in the scene.
inline Vec3 placed(const PlacedInstance* instance, float time, Vec3 p) {
  return instance == nullptr ? p : instance->placement(time).point_to_scene(p).rounded();
}

}  // namespace nocturne

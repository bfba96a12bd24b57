// Where the surfaces lie that may gather light: mirrors, clear glass and surfaces nearly like them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "scene/scene.h"

namespace nocturne {

/// Points, in metres, spread over the shapes whose kernel is specular-like or has a delta lobe, at
/// the first time: a few thousand at most, for photons to be aimed at while none has found the
/// sensor by a path over them. Shapes that are not small compared with the scene are left out:
/// photons that leave for anywhere meet these. `group_of` is the group of a surface, 0 for the
/// scene itself.
std::vector<Vec3> places_on_gatherers(const Scene& scene,
                                      const std::function<std::uint32_t(std::uint32_t)>& group_of);

}  // namespace nocturne

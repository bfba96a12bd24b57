// Searches in a scene's tree for many rays, in turns; the result for a ray does not depend on
// the others, nor on how the tree was built.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "surfaces/embree_scene.h"
#include "surfaces/geometry.h"

namespace nocturne {

/// Of rays that start at their origins: nearest hits before the rays' ends. Where there are none,
/// `hits` stays as it is.
void intersect_tree(const EmbreeScene& scene, std::span<const TimedRay> rays,
                    std::span<std::optional<Hit>> hits);

/// Sets to 1 the rays that are blocked; see Geometry::occluded.
void occluded_tree(const EmbreeScene& scene, std::span<const TimedRay> rays,
                   std::span<std::uint8_t> blocked);

}  // namespace nocturne

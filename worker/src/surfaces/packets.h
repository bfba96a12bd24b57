// Searches by Embree for many rays, eight at a time; the result for a ray does not depend on the
// others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "surfaces/embree_scene.h"
#include "surfaces/geometry.h"

namespace nocturne {

/// Rays in a packet.
inline constexpr std::size_t kPacket = 8;

/// Of rays that start at their origins: the nearest hits before the rays' ends.
void intersect_packets(const EmbreeScene& scene, std::span<const TimedRay> rays,
                       std::span<std::optional<Hit>> hits);

/// Sets to 1 the rays that are blocked by anything in the scene; see Geometry::occluded.
void occluded_packets(RTCScene in, std::span<const TimedRay> rays, std::span<std::uint8_t> blocked,
                      RayCoherence coherence);

}  // namespace nocturne

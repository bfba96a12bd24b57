// Forward photons of a film of many tiles: what a worker does for a photon range.
#pragma once

#include <stop_token>

#include "scene/scene.h"
#include "tile/photon_range.h"

namespace nocturne {

/// What a range of photons from luminaires brings to the whole film, in the order of the photons
/// and rounded as it is sent; products are sums over whole photons, as each of them is drawn
/// independently of the others, and falls on few pixels of a large film. Needs the memory of the
/// film's sums. Throws std::invalid_argument for a scene of adjoint photons alone, and
/// TracingStopped.
TileSums trace_photon_range(const Scene& scene, Film film, std::uint32_t tile_size,
                            const PhotonRange& range, const std::stop_token& stop = {});

}  // namespace nocturne

// Forward photons, which fall anywhere on a film: what a worker does for a photon range.
#pragma once

#include <stop_token>

#include "scene/scene.h"
#include "tile/photon_range.h"

namespace nocturne {

/// What photons [first, end) from luminaires bring to the whole film, in their order; products, of
/// pixels, blocks and tiles, are sums over whole photons, as each is drawn independently of the
/// others. Needs the memory of the film's sums. Throws std::invalid_argument for a scene of adjoint
/// photons alone, and TracingStopped.
TileSums trace_photons(const Scene& scene, Film film, std::uint32_t tile_size, std::uint64_t first,
                       std::uint64_t end, const std::stop_token& stop = {});

/// The same of a range, rounded as it is sent.
TileSums trace_photon_range(const Scene& scene, Film film, std::uint32_t tile_size,
                            const PhotonRange& range, const std::stop_token& stop = {});

}  // namespace nocturne

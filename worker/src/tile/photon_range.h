// Forward photons of a film as separate units of work, and their contribution to its tiles.
#pragma once

#include <cstdint>
#include <string>

#include "tile/tile_sums.h"

namespace nocturne {

/// Photons in a bundle, by which ranges are counted: a fraction of a second of tracing.
inline constexpr std::uint64_t kPhotonBundle = std::uint64_t{1} << 14;

/// Bundles [first, end) of the photons that fall on a film. Photon i is number i % pixels of sample
/// i / pixels.
struct PhotonRange {
  std::uint32_t first, end;

  std::uint64_t photons() const { return (end - first) * kPhotonBundle; }
};

/// Rounds sums of a photon range to the precision that is sent: sums of values to float32, sums of
/// products, which serve for errors alone, to its upper half.
void round_photon_sums(TileSums& sums);

/// Such sums as they are sent, compressed by zlib: a film's are large. One kind of number after the
/// other, and of each first all highest bytes, then the next: sums of X, Y, Z, products, further
/// responses and their squares of all pixels, then products of blocks, then of tiles.
std::string encode_photon_sums(const TileSums& sums);

/// Adds what `bundles` bundles of forward photons brought to a film to what `samples` samples of
/// its pixels did. Means add up, and so do variances of means: the sums are those of as many
/// samples whose parts know nothing of each other. The same arithmetic in the same order as
/// nocturne_scene/photon_sums.py has.
void add_photons(const TileSums& photons, std::uint32_t bundles, std::uint32_t samples,
                 std::uint32_t tile_size, TileSums& film);

}  // namespace nocturne

// A whole image on one machine, cut and merged exactly as the service does it.
#pragma once

#include <functional>
#include <span>
#include <utility>

#include "tracer/trace_tile.h"

namespace nocturne {

/// The cuts of a render plan: square tiles row by row, and where each tile's sample ranges end
/// (increasing).
struct FilmPlan {
  Film film;
  std::uint32_t tile_size;
  /// None: forward photons bring all light.
  std::span<const std::uint32_t> range_ends;
  /// Where the ranges of forward photons end, in bundles; none: there are no such photons.
  std::span<const std::uint32_t> photon_ends = {};

  std::uint32_t samples() const {
    return range_ends.empty() ? samples_of(photon_ends.back()) : range_ends.back();
  }
  /// Of how many samples of each pixel an image by so many bundles of forward photons alone is.
  std::uint32_t samples_of(std::uint32_t bundles) const;

  std::uint32_t columns() const { return (film.width + tile_size - 1) / tile_size; }
  std::size_t tiles() const {
    return std::size_t{columns()} * ((film.height + tile_size - 1) / tile_size);
  }
  /// Of no samples.
  TileRange tile(std::size_t index) const;

  /// The film falls into pieces that can be traced apart: the ranges of forward photons, then the
  /// tiles with all their samples.
  std::size_t pieces() const { return photon_ends.size() + tiles(); }
  /// The part of all photons that a piece is.
  double share(std::size_t piece) const;
};

/// Adds the sums of a tile, the `index`-th, to those of its film.
void add_tile(const TileSums& tile, const TileRange& where, std::size_t index, TileSums& film);

/// Sums of the film, row by row, of so many samples of each pixel; photons, rays and invalid
/// samples of all tiles. A tile's ranges are added up in sample order, and ranges of forward
/// photons in theirs, so the bits don't depend on the number of threads; each thread may hold such
/// a range, which is as large as the film. `progress` is called with the share of photons traced,
/// from any thread, one at a time. Throws the errors that tracing a tile throws.
std::pair<TileSums, std::uint32_t> trace_film(const Scene& scene, const FilmPlan& plan,
                                              unsigned threads,
                                              const std::function<void(double)>& progress);

/// A piece of that. Throws the errors that tracing throws.
TileSums trace_piece(const Scene& scene, const FilmPlan& plan, std::size_t piece);

/// All pieces, each found once and in their order, joined to the bits of `trace_film`; `further`:
/// responses of the sensor.
std::pair<TileSums, std::uint32_t> join_pieces(
    const FilmPlan& plan, std::size_t further,
    const std::function<TileSums(std::size_t piece)>& find);

/// The same bits, one range of the whole film after the other: `wants_more` is asked after each but
/// the last one, with the samples of every pixel so far and their sums, and ends the image there by
/// false. Forward photons go along, as many for each sample in the part as in the whole.
std::pair<TileSums, std::uint32_t> trace_film_by_ranges(
    const Scene& scene, const FilmPlan& plan, unsigned threads,
    const std::function<void(double)>& progress,
    const std::function<bool(std::uint32_t, const TileSums&)>& wants_more);

}  // namespace nocturne

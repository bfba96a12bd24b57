#include "tracer/trace_tile.h"

#include <stdexcept>

#include "tracer/flush_denormals.h"
#include "tracer/trace_pixels.h"
#include "tracer/trace_whole_film.h"

namespace nocturne {
namespace {

/// Photons of which side are traced.
enum class Side { kBoth, kSensor, kLuminaires };

template <int N, bool Media>
TileSums trace_photons(const Scene& scene, Film film, const TileRange& range, Side side,
                       std::uint32_t groups, const std::stop_token& stop) {
  const Direction direction = scene.options.direction;
  const bool whole_film = range.width == film.width && range.height == film.height;
  // Photons from luminaires come in separate ranges where the film has several tiles, or where they
  // are not as many as those from pixels.
  const bool apart = side == Side::kBoth && direction == Direction::kBoth &&
                     (!whole_film || scene.options.forward_ratio != 1.0);
  if (side == Side::kSensor || direction == Direction::kAdjoint || apart) {
    return trace_pixels<N, Media>(scene, film, range, groups, stop);
  }
  if (!whole_film) {
    throw std::invalid_argument("a tile with forward photons that is not the whole film");
  }
  const bool from_pixels = side == Side::kBoth && direction == Direction::kBoth;
  const auto trace = [&](auto film_tracer) {
    return film_tracer.trace(range.first_sample, range.end_sample);
  };
  return direction == Direction::kForward
             ? trace(WholeFilm<N, SensorEstimator<N>, Media>(scene, film, groups, false, stop))
             : trace(
                   WholeFilm<N, CameraEstimator<N>, Media>(scene, film, groups, from_pixels, stop));
}

template <int N>
TileSums trace_in_groups(const Scene& scene, Film film, const TileRange& range, Side side,
                         std::uint32_t groups, const std::stop_token& stop) {
  return scene.media.empty() ? trace_photons<N, false>(scene, film, range, side, groups, stop)
                             : trace_photons<N, true>(scene, film, range, side, groups, stop);
}

TileSums trace_side(const Scene& scene, Film film, const TileRange& range, Side side,
                    std::uint32_t groups, const std::stop_token& stop) {
  const FlushDenormals flush;
  TileSums tile = scene.options.group == 4
                      ? trace_in_groups<4>(scene, film, range, side, groups, stop)
                      : trace_in_groups<1>(scene, film, range, side, groups, stop);
  tile.photons = static_cast<std::uint64_t>(range.width) * range.height *
                 (range.end_sample - range.first_sample) * scene.options.group;
  return tile;
}

}  // namespace

TileSums trace_tile(const Scene& scene, Film film, const TileRange& range,
                    std::uint32_t batch_groups, const std::stop_token& stop) {
  return trace_side(scene, film, range, Side::kBoth, batch_groups, stop);
}

TileSums trace_from_sensor(const Scene& scene, Film film, const TileRange& range,
                           const std::stop_token& stop) {
  return trace_side(scene, film, range, Side::kSensor, kBatchGroups, stop);
}

TileSums trace_from_luminaires(const Scene& scene, Film film, const TileRange& range,
                               const std::stop_token& stop) {
  return trace_side(scene, film, range, Side::kLuminaires, kBatchGroups, stop);
}

}  // namespace nocturne

#include "tracer/trials.h"

#include <algorithm>
#include <cmath>

#include "tracer/by_threads.h"
#include "tracer/trace_tile.h"

namespace nocturne {
namespace {

std::uint32_t squares_along(std::uint32_t film_edge, std::uint32_t edge) {
  return (film_edge + edge - 1) / edge;
}

}  // namespace

double pixels_of(Film film) { return static_cast<double>(film.width) * film.height; }

std::vector<TileRange> whole(Film film, std::uint32_t samples) {
  return {{0, 0, film.width, film.height, 0, samples}};
}

Trials::Trials(Scene& scene, Film film, unsigned threads)
    : scene_(scene), film_(film), threads_(threads), seed_(scene.options.seed) {}

Film Trials::reduced(double pixels) const {
  const double scale = std::sqrt(std::min(1.0, std::max(16.0, pixels) / pixels_of(film_)));
  const auto edge = [&](std::uint32_t full) {
    return std::max(1u, static_cast<std::uint32_t>(std::lround(scale * full)));
  };
  return {edge(film_.width), edge(film_.height)};
}

std::uint32_t Trials::squares_of_film(std::uint32_t edge) const {
  return squares_along(film_.width, edge) * squares_along(film_.height, edge);
}

std::vector<TileRange> Trials::some_squares(double wanted, std::uint32_t edge,
                                            std::uint32_t samples) const {
  const auto [width, height] = film_;
  const std::uint32_t columns = squares_along(width, edge), all = squares_of_film(edge);
  const auto count = static_cast<std::uint32_t>(std::min<double>(wanted, all));
  std::vector<TileRange> squares;
  for (std::uint32_t i = 0; i < count; ++i) {
    double unused;
    const double part = std::modf((i + 0.5) * 0.6180339887498949, &unused);
    const std::uint32_t index = count == all ? i : static_cast<std::uint32_t>(part * all);
    const std::uint32_t x = index % columns * edge, y = index / columns * edge;
    squares.push_back({x, y, std::min(edge, width - x), std::min(edge, height - y), 0, samples});
  }
  return squares;
}

PilotImages Trials::images(Direction direction, std::uint32_t sharing, Film film,
                           const std::vector<TileRange>& squares, std::uint32_t count,
                           bool from_luminaires) {
  scene_.options.direction = direction;
  scene_.options.sharing = sharing;
  PilotImages made{.samples = squares.front().end_sample, .images = {}};
  for (std::uint32_t image = 0; image < count; ++image) {
    scene_.options.seed = seed_ + image;
    made.images.push_back(squares_of(film, squares, from_luminaires));
    for (const TileSums& sums : made.images.back()) {
      photons_ += sums.photons;
      rays_ += sums.rays;
    }
  }
  return made;
}

std::vector<TileSums> Trials::squares_of(Film film, const std::vector<TileRange>& squares,
                                         bool from_luminaires) const {
  std::vector<TileSums> made(squares.size(), TileSums(0, 0, 0));
  by_threads(squares.size(), threads_, [&](std::size_t i) {
    made[i] = from_luminaires ? trace_from_luminaires(scene_, film, squares[i])
                              : trace_from_sensor(scene_, film, squares[i]);
  });
  return made;
}

}  // namespace nocturne

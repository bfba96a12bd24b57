#include "tracer/pilot/trials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/functions.h"
#include "tracer/by_threads.h"
#include "tracer/trace_photon_range.h"
#include "tracer/trace_tile.h"

namespace nocturne {
namespace {

/// Of a small film at least; and how many times higher or lower than asked for it may be if its
/// sides are then as those of the large one, of which its height counts so much less.
constexpr double kLeastPixels = 24.0, kAbout = 1.3, kSizeCounts = 0.1;

std::uint32_t squares_along(std::uint32_t film_edge, std::uint32_t edge) {
  return (film_edge + edge - 1) / edge;
}

}  // namespace

double pixels_of(Film film) { return static_cast<double>(film.width) * film.height; }

std::vector<TileRange> whole(Film film, std::uint32_t end, std::uint32_t first) {
  return {{0, 0, film.width, film.height, first, end}};
}

Trials::Trials(Scene& scene, Film film, unsigned threads)
    : scene_(scene), film_(film), threads_(threads), given_(scene.options) {}

Trials::~Trials() { scene_.options = given_; }

Film Trials::reduced(double pixels) const {
  if (pixels >= pixels_of(film_)) return film_;
  const double aspect = static_cast<double>(film_.width) / film_.height;
  const double height = std::sqrt(std::max(kLeastPixels, pixels) / aspect);
  // Films of another aspect ratio would show more or less of the scene, in few pixels much more.
  Film best{0, 0};
  double least = std::numeric_limits<double>::infinity();
  const double first = std::max(1.0, std::floor(height / kAbout));
  for (double tried = first; tried <= std::max(1.0, height * kAbout); ++tried) {
    const double width = std::max(1.0, std::round(tried * aspect));
    const double off = std::fabs(math::log(width / (tried * aspect))) +
                       kSizeCounts * std::fabs(math::log(tried / height));
    if (off >= least) continue;
    least = off;
    best = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(tried)};
  }
  return best;
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

PilotImages Trials::images(const PhotonKind& kind, Film film, const std::vector<TileRange>& squares,
                           std::uint32_t count) {
  const bool all_light = kind.from == PhotonKind::kSensor;
  scene_.options.direction = all_light ? Direction::kAdjoint : given_.direction;
  scene_.options.sharing = kind.sharing;
  scene_.options.guide = kind.guided;
  scene_.options.aimed_emission = kind.aimed;
  const TileRange& any = squares.front();
  PilotImages made{.samples = any.end_sample - any.first_sample, .images = {}};
  for (std::uint32_t image = 0; image < count; ++image) {
    scene_.options.seed = given_.seed + image;
    made.images.push_back(squares_of(film, squares, kind.from == PhotonKind::kLuminaires));
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
    const TileRange& square = squares[i];
    if (from_luminaires) {
      // They fall on all of the film, of which this is one.
      const std::uint64_t pixels = std::uint64_t{film.width} * film.height;
      made[i] = trace_photons(scene_, film, std::max(film.width, film.height),
                              square.first_sample * pixels, square.end_sample * pixels);
    } else {
      made[i] = trace_tile(scene_, film, square);
    }
  });
  return made;
}

}  // namespace nocturne

// Small images by which a pilot tells ways of tracing apart.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"
#include "tracer/pilot_figures.h"

namespace nocturne {

double pixels_of(Film film);

/// All of a film, so many samples a pixel.
std::vector<TileRange> whole(Film film, std::uint32_t samples);

/// Counts what its images take. Changes direction, sharing and seed of the scene's options, and
/// leaves them changed.
class Trials {
 public:
  /// Independent images by each way.
  static constexpr std::uint32_t kImages = 4;

  Trials(Scene& scene, Film film, unsigned threads);

  /// The same view in so many pixels, about.
  Film reduced(double pixels) const;

  /// Squares of the film, so many pixels along an edge, spread over it (by the golden ratio).
  std::vector<TileRange> some_squares(double wanted, std::uint32_t edge,
                                      std::uint32_t samples) const;
  std::uint32_t squares_of_film(std::uint32_t edge) const;

  /// Independent images of some squares of a film.
  PilotImages images(Direction direction, std::uint32_t sharing, Film film,
                     const std::vector<TileRange>& squares, std::uint32_t count = kImages,
                     bool from_luminaires = false);

  std::uint64_t photons() const { return photons_; }
  std::uint64_t rays() const { return rays_; }

 private:
  std::vector<TileSums> squares_of(Film film, const std::vector<TileRange>& squares,
                                   bool from_luminaires) const;

  Scene& scene_;
  const Film film_;
  const unsigned threads_;
  const std::uint64_t seed_;
  std::uint64_t photons_ = 0, rays_ = 0;
};

}  // namespace nocturne

// Small images by which a pilot distinguishes tracing methods.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"
#include "tracer/pilot/pilot_figures.h"
#include "tracer/pilot/pilot_method.h"

namespace nocturne {

double pixels_of(Film film);

/// All of a film, samples [first, end) of each pixel.
std::vector<TileRange> whole(Film film, std::uint32_t end, std::uint32_t first = 0);

/// Counts what its images take. The options of the scene change meanwhile, and are what
/// they were when it is destroyed.
class Trials {
 public:
  static constexpr std::uint32_t kImages = 4;

  Trials(Scene& scene, Film film, unsigned threads);
  ~Trials();
  Trials(const Trials&) = delete;
  Trials& operator=(const Trials&) = delete;

  /// The same view in so many pixels, about.
  Film reduced(double pixels) const;

  /// Squares of the film, so many pixels along an edge, spread over it (by the golden ratio).
  std::vector<TileRange> some_squares(double wanted, std::uint32_t edge,
                                      std::uint32_t samples) const;
  std::uint32_t squares_of_film(std::uint32_t edge) const;

  /// Images of some squares of a film: independent of each other, and by the same numbers for each
  /// kind of photons.
  PilotImages images(const PhotonKind& kind, Film film, const std::vector<TileRange>& squares,
                     std::uint32_t count = kImages);

  /// As the scene was given.
  const TracingOptions& given() const { return given_; }
  std::uint64_t photons() const { return photons_; }
  std::uint64_t rays() const { return rays_; }

 private:
  std::vector<TileSums> squares_of(Film film, const std::vector<TileRange>& squares,
                                   bool from_luminaires) const;

  Scene& scene_;
  const Film film_;
  const unsigned threads_;
  const TracingOptions given_;
  std::uint64_t photons_ = 0, rays_ = 0;
};

}  // namespace nocturne

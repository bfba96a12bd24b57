// Luminaires that fill a small part of the pixel that sees them, such as the disc of the Sun or a
// lamp far away. Of photons drawn evenly over the pixel few would meet one, and the pixel's error,
// often the whole image's, would be theirs.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "scene/scene.h"
#include "sensors/film.h"

namespace nocturne {

/// A quarter of a pixel's samples is drawn from a rectangle around the small luminaires in it, the
/// rest evenly from the pixel: a mixture of two densities, as in Veach, Robust Monte Carlo Methods
/// for Light Transport Simulation (1997), section 9.2.
class SmallLights {
 public:
  /// A luminaire is small where its rectangle on the film is at most a pixel. None are looked for
  /// on films behind a lens, those of sensors that move or are no camera with one centre, and
  /// among more than 1024 elements of luminaires.
  SmallLights(const Scene& scene, Film film);

  /// Moves a point of a pixel, uniform in [0, 1)^2, to where its sample is taken. Gives the
  /// sample's weight, whose mean is 1: even density over that of the mixture.
  float move(std::uint32_t pixel, float& x, float& y) const {
    if (places_.empty()) return 1.0f;
    const auto found = places_.find(pixel);
    return found == places_.end() ? 1.0f : move_in(found->second, x, y);
  }

  /// Pixels that have one.
  std::size_t pixels() const { return places_.size(); }

 private:
  /// Pixels from the film's top left corner; of a pixel, from the pixel's.
  struct Rectangle {
    float left, top, right, bottom;
    float area() const { return (right - left) * (bottom - top); }
  };

  static float move_in(const Rectangle& place, float& x, float& y);
  void add(Film film, const Rectangle& seen);

  std::unordered_map<std::uint32_t, Rectangle> places_;
};

}  // namespace nocturne

#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace nocturne {

/// Film in pixels; x to the right, y down, from its top left corner.
struct Film {
  std::uint32_t width, height;
};

/// A point of a film, in pixels from its top left corner; may lie outside.
struct FilmPoint {
  float x, y;
};

/// The pixel at a point, in pixels from the film's centre, x to the right and y up; row by row.
inline std::optional<std::uint32_t> pixel_at(Film film, float x, float y) {
  const float column = std::floor(x + 0.5f * static_cast<float>(film.width));
  const float row = std::floor(0.5f * static_cast<float>(film.height) - y);
  // Also false for NaN.
  if (!(column >= 0.0f && column < static_cast<float>(film.width) && row >= 0.0f &&
        row < static_cast<float>(film.height))) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(row) * film.width + static_cast<std::uint32_t>(column);
}

}  // namespace nocturne

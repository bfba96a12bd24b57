// A film that covers all directions: rows are equal steps of the polar angle, columns equal steps
// of the azimuth.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "math/functions.h"
#include "sensors/film.h"

namespace nocturne {

struct DirectionGrid {
  Film film;

  /// Double: in single precision the rows next to the poles of a large film would have no width.
  struct Point {
    double cosine, sine;  // of the polar angle, the latter not negative
    double azimuth;       // [0, 2 pi]
  };

  /// The direction of a film point: uniform over a pixel's solid angle for points uniform in it.
  Point at(float x, float y) const {
    const std::uint32_t row = std::min(static_cast<std::uint32_t>(y), film.height - 1);
    const double top = math::cos(polar(row)), bottom = math::cos(polar(row + 1));
    const double cosine = top + (static_cast<double>(y) - row) * (bottom - top);
    const double azimuth = 2.0 * std::numbers::pi * static_cast<double>(x) / film.width;
    return {cosine, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), azimuth};
  }

  /// Where a direction is: polar angle in [0, pi], any azimuth in [-2 pi, 2 pi].
  FilmPoint film_point(double polar_angle, double azimuth) const {
    const double turn = 2.0 * std::numbers::pi;
    const double around = azimuth < 0.0 ? azimuth + turn : azimuth;
    const std::uint32_t in = row(polar_angle);
    const double top = math::cos(polar(in)), bottom = math::cos(polar(in + 1));
    return {static_cast<float>(around / column_angle()),
            static_cast<float>(in + (math::cos(polar_angle) - top) / (bottom - top))};
  }

  /// Angle between neighbouring rows, radians.
  double row_angle() const { return std::numbers::pi / film.height; }

  /// Angle between neighbouring columns at the equator, radians.
  double column_angle() const { return 2.0 * std::numbers::pi / film.width; }

  /// Of each pixel of a row, sr.
  double solid_angle(std::uint32_t row) const {
    // cos a - cos b, without losing all digits near the poles
    const double middle = 0.5 * (polar(row) + polar(row + 1));
    return column_angle() * 2.0 * math::sin(middle) * math::sin(0.5 * row_angle());
  }

  std::uint32_t row(double polar) const { return cell(polar / row_angle(), film.height); }

  /// Any azimuth in [-2 pi, 2 pi].
  std::uint32_t column(double azimuth) const {
    const double turn = 2.0 * std::numbers::pi;
    return cell((azimuth < 0.0 ? azimuth + turn : azimuth) / column_angle(), film.width);
  }

 private:
  double polar(std::uint32_t row) const { return row * row_angle(); }

  static std::uint32_t cell(double position, std::uint32_t cells) {
    return std::min(static_cast<std::uint32_t>(std::max(0.0, position)), cells - 1);
  }
};

}  // namespace nocturne

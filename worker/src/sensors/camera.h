// A flat film behind a pinhole or a thin lens. A pixel measures the mean radiance over its square
// of the film, and over the lens: an ideal lens without vignetting, so that Y of a pixel is the
// luminance in cd/m2 of what it sees.
#pragma once

#include <cstdint>

#include "math/ray.h"
#include "pdfs/directions.h"

namespace nocturne {

/// Film in pixels.
struct Film {
  std::uint32_t width, height;
};

struct Camera {
  Vec3 position;
  /// Orthonormal.
  Vec3 right, up, forward;
  /// Tangent of half the vertical field of view.
  float tan_half_height;
  /// Metres; zero makes a pinhole.
  float lens_radius;
  /// Distance along `forward` of the plane in focus, metres.
  float focus_distance;

  /// x to the right and y down, in pixels from the film's top left corner; lens point uniform in
  /// the unit square, not used by a pinhole.
  Ray ray(Film film, float x, float y, float lens_u, float lens_v) const {
    const auto height = static_cast<float>(film.height);
    const float scale = 2.0f * tan_half_height / height;
    const float horizontal = (x - 0.5f * static_cast<float>(film.width)) * scale;
    const float vertical = (0.5f * height - y) * scale;
    const Vec3 through = forward + horizontal * right + vertical * up;
    if (lens_radius <= 0.0f) return {position, normalized(through)};
    const Vec3 disc =
        CosineHemisphere::sample(lens_u, lens_v);  // its x, y are uniform on the unit disc
    const Vec3 lens = lens_radius * (disc.x * right + disc.y * up);
    return {position + lens, normalized(focus_distance * through - lens)};
  }
};

}  // namespace nocturne

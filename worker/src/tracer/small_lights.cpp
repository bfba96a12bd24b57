#include "tracer/small_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "math/constants.h"
#include "math/frame.h"
#include "math/functions.h"

namespace nocturne {
namespace {

/// Part of a pixel's samples that is drawn from the rectangle.
constexpr float kShare = 0.25f;
/// Up to this part of the pixel a rectangle is worth separate samples.
constexpr float kWorthwhile = 0.25f;
constexpr float kWidest = 2.0f;  // pixels
constexpr std::size_t kMostElements = 1024;
/// Films are up to 4096 pixels wide, where neighbouring floats are 2^-12 apart.
constexpr float kMargin = 0x1p-10f;
constexpr int kRimPoints = 16;

}  // namespace

SmallLights::SmallLights(const Scene& scene, Film film) {
  const Sensor& sensor = scene.sensor;
  const Elements& elements = scene.lights.luminaires().elements();
  // The rectangle around the points seen in these directions, if all of them are on the film.
  const auto rectangle = [&](std::span<const Vec3> directions) -> std::optional<Rectangle> {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    Rectangle seen{kFar, kFar, -kFar, -kFar};
    for (const Vec3 direction : directions) {
      const auto point = sensor.film_point(film, direction);
      if (!point) return std::nullopt;
      seen = {std::min(seen.left, point->x), std::min(seen.top, point->y),
              std::max(seen.right, point->x), std::max(seen.bottom, point->y)};
    }
    // A light across the seam of a panorama is as wide as the film.
    if (!(seen.area() <= 1.0f && seen.right - seen.left <= kWidest &&
          seen.bottom - seen.top <= kWidest)) {
      return std::nullopt;
    }
    return Rectangle{seen.left - kMargin, seen.top - kMargin, seen.right + kMargin,
                     seen.bottom + kMargin};
  };
  for (const DistantDisc& disc : scene.lights.discs()) {
    if (disc.hidden_from != HiddenFrom::kNobody) continue;
    // Corners of a polygon around the disc.
    const Frame frame(disc.direction());
    const float radius = disc.tan_half_angle() / math::cos(kPi / kRimPoints);
    std::array<Vec3, kRimPoints> rim;
    for (int i = 0; i < kRimPoints; ++i) {
      const float turn = kTwoPi * static_cast<float>(i) / kRimPoints;
      rim[static_cast<std::size_t>(i)] =
          frame.to_world({radius * math::cos(turn), radius * math::sin(turn), 1.0f});
    }
    if (const auto seen = rectangle(rim)) add(film, *seen);
  }
  if (elements.size() <= kMostElements) {
    const Vec3 place = sensor.place();
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const ElementBounds& bounds = elements.bounds(i);
      if (!(bounds.weight > 0.0)) continue;
      if (scene.luminaires[elements.luminaire(i)].hidden_from != HiddenFrom::kNobody) continue;
      std::array<Vec3, 8> corners;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vec3 corner{(k & 1) != 0 ? bounds.high.x : bounds.low.x,
                          (k & 2) != 0 ? bounds.high.y : bounds.low.y,
                          (k & 4) != 0 ? bounds.high.z : bounds.low.z};
        corners[k] = corner - place;
      }
      if (const auto seen = rectangle(corners)) add(film, *seen);
    }
  }
  std::erase_if(places_, [](const auto& each) { return each.second.area() > kWorthwhile; });
}

/// Enlarges the rectangle of each pixel that `seen` meets so that it holds `seen` there too.
void SmallLights::add(Film film, const Rectangle& seen) {
  // As a whole number within the film: the seen rectangle may lie farther outside it than an
  // integer can hold.
  const auto within = [](float place, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp(place, 0.0f, static_cast<float>(size)));
  };
  const std::uint32_t left = within(std::floor(seen.left), film.width);
  const std::uint32_t right = within(std::ceil(seen.right), film.width);
  const std::uint32_t bottom = within(std::ceil(seen.bottom), film.height);
  for (std::uint32_t row = within(std::floor(seen.top), film.height); row < bottom; ++row) {
    for (std::uint32_t column = left; column < right; ++column) {
      const auto x = static_cast<float>(column), y = static_cast<float>(row);
      const Rectangle part{std::max(0.0f, seen.left - x), std::max(0.0f, seen.top - y),
                           std::min(1.0f, seen.right - x), std::min(1.0f, seen.bottom - y)};
      if (!(part.right > part.left && part.bottom > part.top)) continue;
      const std::uint32_t pixel = row * film.width + column;
      const auto [there, is_new] = places_.try_emplace(pixel, part);
      Rectangle& all = there->second;
      if (is_new) continue;
      all = {std::min(all.left, part.left), std::min(all.top, part.top),
             std::max(all.right, part.right), std::max(all.bottom, part.bottom)};
    }
  }
}

float SmallLights::move_in(const Rectangle& place, float& x, float& y) {
  if (x < kShare) {
    x = std::min(place.right, place.left + x / kShare * (place.right - place.left));
    y = std::min(place.bottom, place.top + y * (place.bottom - place.top));
  } else {
    x = (x - kShare) / (1.0f - kShare);
  }
  const bool inside = x >= place.left && x <= place.right && y >= place.top && y <= place.bottom;
  return 1.0f / (1.0f - kShare + (inside ? kShare / place.area() : 0.0f));
}

}  // namespace nocturne

// The opening of a lens: a disc, or a regular polygon as iris blades make it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "math/constants.h"
#include "math/functions.h"
#include "pdfs/directions.h"

namespace nocturne {

class Aperture {
 public:
  static constexpr std::uint32_t kMaxBlades = 64;  // more can't be told from a disc

  /// In metres across the lens: x to the sensor's right, y up.
  struct Point {
    float x, y;
  };

  /// Corners on the circle of `radius` (metres, > 0), the first at `angle` (radians) from x towards
  /// y; 0 blades: a disc. Throws std::invalid_argument for 1, 2 or more than kMaxBlades blades.
  Aperture(float radius, std::uint32_t blades, float angle) : radius_(radius) {
    if (!(radius > 0.0f)) throw std::invalid_argument("a lens without a radius");
    if (blades == 0) return;
    if (blades < 3 || blades > kMaxBlades) {
      throw std::invalid_argument("an aperture with 1, 2 or more than 64 blades");
    }
    for (std::uint32_t i = 0; i <= blades; ++i) {
      const float corner =
          angle + kTwoPi * static_cast<float>(i % blades) / static_cast<float>(blades);
      corners_.push_back({radius * math::cos(corner), radius * math::sin(corner)});
    }
  }

  /// Uniform over the area for uniform u, v in [0, 1).
  Point sample(float u, float v) const {
    if (corners_.empty()) {
      const Vec3 disc = CosineHemisphere::sample(u, v);  // its x, y are uniform on the unit disc
      return {radius_ * disc.x, radius_ * disc.y};
    }
    // A triangle from the centre for each blade; u says which, and its remainder how far out.
    const std::size_t blades = corners_.size() - 1;
    const float position = u * static_cast<float>(blades);
    const std::size_t blade = std::min(static_cast<std::size_t>(position), blades - 1);
    const float outwards = std::sqrt(position - static_cast<float>(blade));
    const Point a = corners_[blade], b = corners_[blade + 1];
    return {outwards * (a.x + v * (b.x - a.x)), outwards * (a.y + v * (b.y - a.y))};
  }

  float radius() const { return radius_; }

 private:
  float radius_;
  std::vector<Point> corners_;  // the first one again at the end
};

}  // namespace nocturne

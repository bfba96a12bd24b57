// The sky in patches (P. Tregenza, "Subdivision of the sky hemisphere for luminance measurements",
// Lighting Research and Technology 19 (1987) 13), and these divided again (C. Reinhart): rows of
// equal height around the zenith, which is a separate patch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "math/constants.h"
#include "math/functions.h"
#include "math/vec3.h"

namespace nocturne {

class SkyPatches {
 public:
  static constexpr std::uint32_t kMostDivisions = 8;

  /// Each of Tregenza's 144 patches around the zenith's becomes divisions x divisions. `up` and
  /// `north` have unit length and are across each other. Throws std::invalid_argument.
  SkyPatches(std::uint32_t divisions, Vec3 up, Vec3 north) : up_(up), north_(north) {
    if (divisions == 0 || divisions > kMostDivisions) {
      throw std::invalid_argument("patches of the sky in none or more than 8 x 8 divisions");
    }
    const auto small = [](float x) { return std::fabs(x) < 1e-4f; };
    if (!small(dot(up, up) - 1.0f) || !small(dot(north, north) - 1.0f) || !small(dot(up, north))) {
      throw std::invalid_argument("the sky's up and north are not orthonormal");
    }
    east_ = cross(north, up);
    std::uint32_t first = 1;
    for (const std::uint32_t around : kAround) {
      for (std::uint32_t i = 0; i < divisions; ++i) {
        rows_.push_back({first, around * divisions});
        first += around * divisions;
      }
    }
    rows_.push_back({first, 1});
    height_ = 0.5f * kPi / (static_cast<float>(rows_.size()) - 0.5f);
  }

  /// Patch 0 is all below the horizon.
  std::uint32_t count() const { return rows_.back().first + 1; }

  /// Of a unit direction. Patches of a row are numbered from north to east; the first is around
  /// north.
  std::uint32_t number(Vec3 direction) const {
    const float height = dot(direction, up_);
    if (height < 0.0f) return 0;
    const float altitude = 0.5f * kPi - math::acos(std::min(height, 1.0f));
    const auto row =
        std::min(static_cast<std::size_t>(altitude / height_), rows_.size() - std::size_t{1});
    const auto [first, around] = rows_[row];
    const float turn = math::atan2(dot(direction, east_), dot(direction, north_)) * (0.5f * kInvPi);
    const float place = (turn - std::floor(turn)) * static_cast<float>(around) + 0.5f;
    return first + static_cast<std::uint32_t>(place) % around;
  }

 private:
  struct Row {
    std::uint32_t first, around;
  };
  static constexpr std::array<std::uint32_t, 7> kAround{30, 30, 24, 24, 18, 12, 6};

  Vec3 up_, north_, east_;
  std::vector<Row> rows_;
  float height_;
};

}  // namespace nocturne

#include "luminaires/intensity_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "math/constants.h"
#include "math/functions.h"

namespace nocturne {
namespace {

// Angles are rounded to float: a direction this close to the rim of the table is in it.
constexpr float kAngleRounding = 2e-6f;

void check_angles(const std::vector<float>& angles, std::size_t least, float largest) {
  if (angles.size() < least) throw std::invalid_argument("an intensity profile lacks angles");
  if (!(angles.front() >= 0.0f && angles.back() <= largest + kAngleRounding)) {
    throw std::invalid_argument("an angle of an intensity profile is out of range");
  }
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (!(angles[i] > angles[i - 1])) {
      throw std::invalid_argument("the angles of an intensity profile don't increase");
    }
  }
}

struct ProfileCell {
  std::size_t cell;
  float t;
};

std::optional<ProfileCell> place(const std::vector<float>& knots, float angle) {
  if (angle < knots.front() - kAngleRounding || angle > knots.back() + kAngleRounding) {
    return std::nullopt;
  }
  const auto above = std::upper_bound(knots.begin() + 1, knots.end() - 1, angle);
  const auto cell = static_cast<std::size_t>(above - knots.begin()) - 1;
  return ProfileCell{
      cell, std::clamp((angle - knots[cell]) / (knots[cell + 1] - knots[cell]), 0.0f, 1.0f)};
}

// The integral of (linear from a to b) sin(theta) between two angles.
double integrate_row(const std::vector<float>& angles, const float* values) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < angles.size(); ++i) {
    const double low = angles[i], high = angles[i + 1];
    const double slope = (static_cast<double>(values[i + 1]) - values[i]) / (high - low);
    const double start = values[i] - slope * low;
    const auto primitive = [&](double theta) {
      return -start * math::cos(theta) + slope * (math::sin(theta) - theta * math::cos(theta));
    };
    sum += primitive(high) - primitive(low);
  }
  return sum;
}

}  // namespace

IntensityProfile::IntensityProfile(Table table)
    : table_(std::move(table)), side_(cross(table_.axis, table_.zero)) {
  const auto is_unit = [](Vec3 v) { return std::fabs(length(v) - 1.0f) < 1e-4f; };
  if (!is_unit(table_.axis) || !is_unit(table_.zero) || !is_unit(side_)) {
    throw std::invalid_argument("the axes of an intensity profile are not orthonormal");
  }
  check_angles(table_.vertical, 2, kPi);
  check_angles(table_.horizontal, 1, kTwoPi);
  if (table_.values.size() != table_.vertical.size() * table_.horizontal.size()) {
    throw std::invalid_argument("an intensity profile needs a value for each pair of angles");
  }
  for (const float value : table_.values) {
    if (!(value >= 0.0f && std::isfinite(value))) {
      throw std::invalid_argument("an intensity is negative or not finite");
    }
  }
}

float IntensityProfile::operator()(Vec3 direction) const {
  const float x = dot(direction, table_.zero), y = dot(direction, side_),
              z = dot(direction, table_.axis);
  const auto v = place(table_.vertical, math::atan2(std::sqrt(x * x + y * y), z));
  if (!v) return 0.0f;
  const std::size_t row = table_.vertical.size();
  const auto along = [&](std::size_t column) {
    const float* values = &table_.values[column * row + v->cell];
    return values[0] + v->t * (values[1] - values[0]);
  };
  if (table_.horizontal.size() == 1) return along(0);
  const float phi = math::atan2(y, x);
  const auto h = place(table_.horizontal, phi < 0.0f ? phi + kTwoPi : phi);
  if (!h) return 0.0f;
  const float left = along(h->cell), right = along(h->cell + 1);
  return left + h->t * (right - left);
}

double IntensityProfile::flux() const {
  const std::size_t row = table_.vertical.size();
  if (table_.horizontal.size() == 1) {
    return 2.0 * std::numbers::pi * integrate_row(table_.vertical, table_.values.data());
  }
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < table_.horizontal.size(); ++i) {
    const double width = static_cast<double>(table_.horizontal[i + 1]) - table_.horizontal[i];
    sum += 0.5 * width *
           (integrate_row(table_.vertical, &table_.values[i * row]) +
            integrate_row(table_.vertical, &table_.values[(i + 1) * row]));
  }
  return sum;
}

}  // namespace nocturne

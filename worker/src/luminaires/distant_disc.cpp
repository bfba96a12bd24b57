#include "luminaires/distant_disc.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "luminaires/light_sampling_context.h"
#include "math/constants.h"
#include "math/functions.h"

namespace nocturne {
namespace {

double one_minus_cosine(double angle) {
  const double s = math::sin(0.5 * angle);
  return 2.0 * s * s;
}

Vec3 checked_unit(Vec3 direction) {
  if (!(std::fabs(length(direction) - 1.0f) < 1e-4f)) {
    throw std::invalid_argument("the direction of a distant disc is not a unit vector");
  }
  return normalized(direction);
}

}  // namespace

DistantDisc::DistantDisc(Vec3 direction, double half_angle, Spectrum radiance, LimbDarkening limb)
    : frame_(checked_unit(direction)), radiance_(std::move(radiance)), limb_(std::move(limb)) {
  // Half a unit of float beyond pi/2, which a document may well say in single precision.
  if (!(half_angle > 0.0 && half_angle <= 0.5 * std::numbers::pi + 1e-7)) {
    throw std::invalid_argument("the half angle of a distant disc is not in (0, pi/2]");
  }
  const double wide = half_angle + kDirectionRounding;
  const double sine = math::sin(half_angle);
  drop_ = static_cast<float>(one_minus_cosine(half_angle));
  wide_drop_ = static_cast<float>(one_minus_cosine(wide));
  inverse_sin2_ = static_cast<float>(1.0 / (sine * sine));
  sin_ = static_cast<float>(
      half_angle + kDirectionRounding < 0.5 * std::numbers::pi ? math::sin(wide) : 1.0);
  density_ = static_cast<float>(1.0 / (2.0 * std::numbers::pi * one_minus_cosine(wide)));
  perpendicular_ = static_cast<float>(std::numbers::pi * sine * sine * radiance_.mean());
}

Vec3 DistantDisc::sample(float u1, float u2) const {
  const float drop = u1 * wide_drop_;
  const float r = std::sqrt(drop * (2.0f - drop)), phi = kTwoPi * u2;
  return normalized(frame_.to_world({r * math::cos(phi), r * math::sin(phi), 1.0f - drop}));
}

float DistantDisc::irradiance(Vec3 normal, bool both_sides) const {
  const float cosine = dot(normal, frame_.normal);
  if (both_sides) return perpendicular_ * std::max(std::fabs(cosine), sin_ / 4.0f);
  if (cosine <= -sin_) return 0.0f;
  // Straddling the horizon: some of the disc's own width.
  return perpendicular_ * std::max(cosine, 0.25f * (sin_ + std::min(cosine, 0.0f)));
}

}  // namespace nocturne

#include "kernels/beckmann.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/ggx.h"
#include "math/functions.h"

namespace nocturne {
namespace {

constexpr double kInvSqrtPi = std::numbers::inv_sqrtpi;
// Slopes beyond are met once in 1e16.
constexpr double kSteepest = 6.0;
// As fine as single precision tells random numbers apart; four steps reach it nearly always.
constexpr double kNear = 0x1p-24;
constexpr int kMostSteps = 20;
constexpr double kFlatMost = 1.0 - kNear;

// The integral of (c - t s) exp(-t^2) / sqrt pi from minus infinity to x: facets of slope up to x,
// as they are seen from the direction (s, c) of a surface of roughness 1.
double seen_below(double s, double c, double x) {
  return 0.5 * c * math::erfc(-x) + 0.5 * s * kInvSqrtPi * math::exp(-x * x);
}

double steepest_seen(double s, double c) { return s * kSteepest > c ? c / s : kSteepest; }

// Where seen_below is the part u of all that is seen: by Newton's method on the error function of
// the slope, in which seen_below is nearly straight, from a fit to the solution. Jakob, "An
// Improved Visible Normal Sampling Routine for the Beckmann Distribution", ETH Zurich 2014.
double drawn_slope(double s, double c, double u) {
  const double steepest = steepest_seen(s, c);
  const double end = math::erfc(-steepest) - 1.0;
  const double seen = 0.5 * ((1.0 + end) * c + s * kInvSqrtPi * math::exp(-steepest * steepest));
  const double angle = math::acos(std::min(c, 1.0));
  const double fitted = 1.0 + angle * (-0.876 + angle * (0.4265 - 0.0594 * angle));
  double low = -1.0, high = end, slope = 0.0;
  double at = end - (1.0 + end) * math::pow(1.0 - u, fitted);
  for (int i = 0; i < kMostSteps; ++i) {
    if (!(at > low && at < high)) at = 0.5 * (low + high);
    slope = math::erf_inverse(at);
    const double below = 0.5 * ((1.0 + at) * c + s * kInvSqrtPi * math::exp(-slope * slope));
    const double beyond = below - u * seen;
    if (std::fabs(beyond) < kNear * seen) break;
    (beyond < 0.0 ? low : high) = at;
    at -= 2.0 * beyond / (c - s * slope);
  }
  return slope;
}

// A direction where the roughness is 1: along the surface, and across it.
struct Stretched {
  double x, y, s, c;
  Stretched(const Beckmann& facets, Vec3 w)
      : x(static_cast<double>(facets.alpha_u * w.x)),
        y(static_cast<double>(facets.alpha_v * w.y)),
        s(std::sqrt(x * x + y * y)),
        c(std::fabs(static_cast<double>(w.z))) {}

  // |w.z| (1 + Lambda(w)).
  double seen() const { return seen_below(s, c, steepest_seen(s, c)); }
  double lambda() const { return std::max(0.0, seen() / std::max(1e-30, c) - 1.0); }
};

}  // namespace

float Beckmann::density(Vec3 h) const {
  const double x = static_cast<double>(h.x / alpha_u), y = static_cast<double>(h.y / alpha_v);
  const double z2 = static_cast<double>(h.z) * static_cast<double>(h.z);
  if (!(z2 > 0.0)) return 0.0f;
  return static_cast<float>(math::exp(-(x * x + y * y) / z2) * std::numbers::inv_pi /
                            (static_cast<double>(alpha_u * alpha_v) * z2 * z2));
}

Vec3 Beckmann::sample_visible(Vec3 wo, float u, float v) const {
  const Stretched from(*this, wo);
  const double length = math::hypot(from.s, from.c);
  const double along = drawn_slope(from.s / length, from.c / length, static_cast<double>(u));
  // Half a step of the random numbers from the ends, where slopes are infinite.
  const double across =
      math::erf_inverse(std::clamp(2.0 * static_cast<double>(v) - 1.0, -kFlatMost, kFlatMost));
  const double cosine = from.s > 0.0 ? from.x / from.s : 1.0;
  const double sine = from.s > 0.0 ? from.y / from.s : 0.0;
  return normalized(Vec3{-alpha_u * static_cast<float>(along * cosine - across * sine),
                         -alpha_v * static_cast<float>(along * sine + across * cosine), 1.0f});
}

float Beckmann::visible(Vec3 wo, Vec3 h) const {
  return static_cast<float>(static_cast<double>(std::max(0.0f, dot(wo, h)) * density(h)) /
                            Stretched(*this, wo).seen());
}

float Beckmann::reflection_pdf(Vec3 wo, Vec3 h) const {
  return static_cast<float>(0.25 * static_cast<double>(density(h)) / Stretched(*this, wo).seen());
}

float Beckmann::reflection_weight(Vec3 wo, Vec3 wi) const {
  const double o = Stretched(*this, wo).lambda(), i = Stretched(*this, wi).lambda();
  return static_cast<float>((1.0 + o) / (1.0 + o + i));
}

float Beckmann::transmission_weight(Vec3 wo, Vec3 wi) const {
  const double o = Stretched(*this, wo).lambda(), i = Stretched(*this, wi).lambda();
  return static_cast<float>(std::min(1.0, beta_1p(o, i) * (1.0 + o)));
}

}  // namespace nocturne

#include "luminaires/patch.h"

#include <limits>
#include <numbers>

#include "luminaires/spherical_triangle.h"

namespace nocturne {
namespace {

// Solid angle is used up to this many areas' square root away. Spread of the irradiance from one
// direction, over its mean, below the middle of a lamp of 1 m x 1 m (Irradiance.
// SquareLampFromCloseBy in tests/worker/luminaires): at 0.1 m 3.2 by area, 0.41 by solid angle; at
// 0.5 m 0.51 and 0.12; at 1 m 0.17 and 0.04; at 2 m 0.05 and 0.01, where either is as good compared
// with the other noise of an image and area is faster.
constexpr float kNearAreas = 2.25f;

// Outside of these the arithmetic loses digits: nearly edge-on, or nearly in its plane.
constexpr double kMinSolidAngle = 1e-5, kMaxSolidAngle = 2.0 * std::numbers::pi - 1e-4;

// One triangle, or the two of a parallelogram.
struct NearView {
  SphericalTriangle first, second;
  double first_angle, total;

  static NearView make(const Patch& p, Vec3 position) {
    const auto towards = [&](double u, double v) {
      return (Double3(p.corner) + u * p.edge_u + v * p.edge_v - Double3(position)).normalized();
    };
    const Double3 a = towards(0, 0), b = towards(1, 0), c = towards(0, 1);
    const SphericalTriangle first(a, b, c);
    const SphericalTriangle second(p.triangle ? a : towards(1, 1), c, b);
    const double rest = p.triangle ? 0.0 : second.solid_angle();
    return {first, second, first.solid_angle(), first.solid_angle() + rest};
  }

  // Also false for a position on a corner, where nothing is a number.
  bool usable() const { return total > kMinSolidAngle && total < kMaxSolidAngle; }
};

}  // namespace

Patch Patch::make(Vec3 corner, Double3 edge_u, Double3 edge_v, bool triangle, bool two_sided) {
  const Double3 n = cross(edge_u, edge_v);
  Patch p{corner, edge_u, edge_v, n, {}, {}, n.rounded(), {}, {}, 0.0f, -1.0f, triangle, two_sided};
  p.centre = (Double3(corner) + (triangle ? 1.0 / 3.0 : 0.5) * (edge_u + edge_v)).rounded();
  const float n2 = dot(p.normal, p.normal);
  if (!(n2 > 0.0f) || !std::isfinite(1.0f / n2)) return p;  // no area
  const double inverse = 1.0 / dot(n, n);
  p.dual_u = inverse * cross(edge_v, n);
  p.dual_v = inverse * cross(n, edge_u);
  p.unit_normal = (std::sqrt(inverse) * n).rounded();
  p.longest_edge =
      static_cast<float>(std::max({max_abs(edge_u), max_abs(edge_v), max_abs(edge_v - edge_u)}));
  p.near2 = kNearAreas * p.area();
  return p;
}

std::optional<ElementSample> Patch::draw_near(Vec3 position, float u1, float u2) const {
  const NearView view = NearView::make(*this, position);
  if (!view.usable()) return std::nullopt;
  const double target = u1 * view.total;
  const bool second_one = !triangle && target >= view.first_angle;
  const double u = second_one ? (target - view.first_angle) / (view.total - view.first_angle)
                              : target / view.first_angle;
  const Double3 d = (second_one ? view.second : view.first).sample(u, u2);
  const Vec3 direction = d.rounded();
  auto distance = static_cast<float>(dot(Double3(corner) - Double3(position), across) /
                                     dot(Double3(direction), across));
  if (!(distance > 0.0f)) distance = std::numeric_limits<float>::infinity();
  return ElementSample{direction, static_cast<float>(1.0 / view.total), distance,
                       meet(position + distance * direction, distance)};
}

float Patch::near_pdf(Vec3 position) const {
  const NearView view = NearView::make(*this, position);
  return view.usable() ? static_cast<float>(1.0 / view.total) : 0.0f;
}

}  // namespace nocturne

#include "luminaires/elements.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "math/time_steps.h"

namespace nocturne {
namespace {

void check(const Emission& e, std::size_t steps) {
  if (steps == 0) throw std::invalid_argument("an element of a luminaire has no time step");
  if (!(e.radiance >= 0.0f) || !std::isfinite(e.radiance)) {
    throw std::invalid_argument("the radiance of a luminaire is negative or not finite");
  }
  if (!(e.cosine_power >= Emission::kAnyDirection) || !std::isfinite(e.cosine_power)) {
    throw std::invalid_argument("the cosine power of a luminaire is out of range");
  }
}

void check(Vec3 v) {
  if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
    throw std::invalid_argument("a corner of a luminaire is not finite");
  }
}

ElementBounds empty_bounds(const Emission& emission) {
  ElementBounds b;
  b.two_sided = emission.two_sided;
  b.cosine_power = emission.cosine_power;
  return b;
}

Vec3 between(Vec3 a, Vec3 b, float t) { return a + t * (b - a); }
Double3 between(Double3 a, Double3 b, float t) { return a + double{t} * (b - a); }

}  // namespace

void Elements::add_triangle(std::span<const std::array<Vec3, 3>> corners,
                            const Emission& emission) {
  add_patch(corners, true, emission);
}

void Elements::add_parallelogram(std::span<const std::array<Vec3, 3>> corners,
                                 const Emission& emission) {
  add_patch(corners, false, emission);
}

void Elements::add_patch(std::span<const std::array<Vec3, 3>> corners, bool triangle,
                         const Emission& emission) {
  check(emission, corners.size());
  ElementBounds bounds = empty_bounds(emission);
  std::vector<Patch> states;
  float area = 0.0f, largest_area = -1.0f;
  for (const auto& c : corners) {
    for (const Vec3 v : c) {
      check(v);
      bounds.add(v);
    }
    states.push_back(Patch::make(c[0], Double3(c[1]) - Double3(c[0]), Double3(c[2]) - Double3(c[0]),
                                 triangle, emission.two_sided));
    const Patch& patch = states.back();
    if (!triangle) bounds.add((Double3(c[1]) + patch.edge_v).rounded());
    area = patch.has_area() ? patch.area() : 0.0f;
    if (area > largest_area) {
      largest_area = area;
      if (area > 0.0f) bounds.axis = (1.0f / length(patch.normal)) * patch.normal;
    }
  }
  if (!(largest_area > 0.0f) || !(emission.radiance > 0.0f)) return;
  // One that only shifts keeps its normal; of one that turns or bends any may come.
  for (const Patch& patch : states) {
    if (!(dot(patch.normal, bounds.axis) > (1.0f - 1e-6f) * length(patch.normal))) {
      bounds.cos_spread = -1.0f;
    }
  }
  bounds.weight = static_cast<double>(emission.radiance) * largest_area;
  entries_.push_back({states.size() == 1 ? Kind::kPatch : Kind::kMovingPatch,
                      static_cast<std::uint32_t>(patches_.size()),
                      static_cast<std::uint32_t>(states.size()), emission.luminaire, bounds});
  patches_.insert(patches_.end(), states.begin(), states.end());
}

void Elements::add_sphere(std::span<const Sphere> spheres, const Emission& emission) {
  check(emission, spheres.size());
  ElementBounds bounds = empty_bounds(emission);
  bounds.axis = {0, 0, 1};
  bounds.cos_spread = -1.0f;
  double radius = 0.0;
  for (const Sphere& s : spheres) {
    if (!std::isfinite(s.x) || !std::isfinite(s.y) || !std::isfinite(s.z) || !(s.radius >= 0.0) ||
        !std::isfinite(s.radius)) {
      throw std::invalid_argument("a sphere of a luminaire is not finite");
    }
    const auto centre =
        Vec3{static_cast<float>(s.x), static_cast<float>(s.y), static_cast<float>(s.z)};
    const float r = std::nextafter(static_cast<float>(s.radius), 2e38f) + 1e-6f * max_abs(centre);
    bounds.add(centre - Vec3{r, r, r});
    bounds.add(centre + Vec3{r, r, r});
    radius = std::max(radius, s.radius);
  }
  if (!(radius > 0.0) || !(emission.radiance > 0.0f)) return;
  bounds.weight = emission.radiance * std::numbers::pi * radius * radius;
  entries_.push_back({spheres.size() == 1 ? Kind::kBall : Kind::kMovingBall,
                      static_cast<std::uint32_t>(balls_.size()),
                      static_cast<std::uint32_t>(spheres.size()), emission.luminaire, bounds});
  for (const Sphere& s : spheres) balls_.push_back({s, emission.two_sided});
}

void Elements::add_mesh(std::span<const std::span<const Vec3>> vertices,
                        std::span<const std::array<std::uint32_t, 3>> triangles,
                        const Emission& emission) {
  std::vector<std::array<Vec3, 3>> corners(vertices.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    const auto closes_parallelogram = [&](const std::array<std::uint32_t, 3>& next) {
      if (next[0] != t[0] || next[1] != t[2]) return false;
      return std::all_of(vertices.begin(), vertices.end(), [&](std::span<const Vec3> v) {
        const Vec3 gap = (v[next[2]] - v[t[0]]) - (v[t[2]] - v[t[1]]);
        return gap.x == 0.0f && gap.y == 0.0f && gap.z == 0.0f;
      });
    };
    const bool both = i + 1 < triangles.size() && closes_parallelogram(triangles[i + 1]);
    const std::uint32_t last = both ? triangles[i + 1][2] : t[2];
    for (std::size_t step = 0; step < vertices.size(); ++step) {
      corners[step] = {vertices[step][t[0]], vertices[step][t[1]], vertices[step][last]};
    }
    add_patch(corners, !both, emission);
    if (both) ++i;
  }
}

void Elements::share_weight(std::size_t first, double weight) {
  double total = 0.0;
  for (std::size_t i = first; i < entries_.size(); ++i) total += entries_[i].bounds.weight;
  if (!(total > 0.0)) return;
  for (std::size_t i = first; i < entries_.size(); ++i) entries_[i].bounds.weight *= weight / total;
}

double Elements::total_weight() const {
  double total = 0.0;
  for (const Entry& entry : entries_) total += entry.bounds.weight;
  return total;
}

Patch Elements::patch_at(const Entry& entry, float time) const {
  const auto [step, t] = segment_at(time, entry.steps);
  const Patch& a = patches_[entry.first + step];
  const Patch& b = patches_[entry.first + step + 1];
  return Patch::make(between(a.corner, b.corner, t), between(a.edge_u, b.edge_u, t),
                     between(a.edge_v, b.edge_v, t), a.triangle, a.two_sided);
}

Ball Elements::ball_at(const Entry& entry, float time) const {
  const auto [step, t] = segment_at(time, entry.steps);
  const Sphere& a = balls_[entry.first + step].sphere;
  const Sphere& b = balls_[entry.first + step + 1].sphere;
  const auto mix = [fraction = t](double x, double y) { return x + fraction * (y - x); };
  return {{mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z), mix(a.radius, b.radius)},
          balls_[entry.first].two_sided};
}

std::optional<DrawnDirection> Elements::sample_moving(const Entry& entry,
                                                      const LightSamplingContext& from, float u1,
                                                      float u2) const {
  if (entry.kind == Kind::kMovingPatch) {
    return patch_at(entry, from.time).sample(from.position, u1, u2);
  }
  return ball_at(entry, from.time).sample(from.position, u1, u2);
}

std::optional<ElementSample> Elements::draw_moving(const Entry& entry,
                                                   const LightSamplingContext& from, float u1,
                                                   float u2) const {
  if (entry.kind == Kind::kMovingPatch) {
    return patch_at(entry, from.time).draw(from.position, u1, u2);
  }
  return ball_at(entry, from.time).draw(from.position, u1, u2);
}

OnHalfLine Elements::moving_along(const Entry& entry, const LightSamplingContext& from,
                                  Vec3 direction) const {
  if (entry.kind == Kind::kMovingPatch) {
    return patch_at(entry, from.time).along(from.position, direction);
  }
  return ball_at(entry, from.time).along(from.position, direction);
}

ElementPoint Elements::point_at(std::size_t i, const LightSamplingContext& from, Vec3 direction,
                                float distance) const {
  const Entry& entry = entries_[i];
  switch (entry.kind) {
    case Kind::kPatch:
      return patches_[entry.first].point_at(from.position, direction, distance);
    case Kind::kBall:
      return balls_[entry.first].point_at(from.position, direction, distance);
    case Kind::kMovingPatch:
      return patch_at(entry, from.time).point_at(from.position, direction, distance);
    default:
      return ball_at(entry, from.time).point_at(from.position, direction, distance);
  }
}

}  // namespace nocturne

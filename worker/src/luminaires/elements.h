// What directions are drawn towards: triangles, parallelograms and spheres, in place in the scene,
// at rest or moving. Made by whoever loads the scene, for luminaires and for important shapes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luminaires/ball.h"
#include "luminaires/patch.h"
#include "math/box.h"
#include "surfaces/shapes.h"

namespace nocturne {

/// How an element emits, as far as choosing it goes.
struct Emission {
  /// Intensity that does not fall with the angle to the normal: radiance goes by 1 / cos.
  static constexpr float kAnyDirection = -1.0f;

  /// Along the normal, mean over wavelengths; not negative. Zero: never drawn.
  float radiance = 0.0f;
  bool two_sided = false;
  /// Radiance goes by cos^power of the angle to the normal; at least -1.
  float cosine_power = 0.0f;
  /// Whose element it is; important shapes are none's.
  std::uint32_t luminaire = kNoLuminaire;

  static constexpr std::uint32_t kNoLuminaire = ~0u;
};

/// Bounds of an element over the shutter, and of its emission; for a set, of all of them.
struct ElementBounds : Box {
  /// All normals are within the cone of this cosine around the axis.
  Vec3 axis;
  float cos_spread = 1.0f;
  bool two_sided = false;
  float cosine_power = 0.0f;
  /// Irradiance is at most about weight x cos^(power + 1) / distance^2: radiance x area.
  double weight = 0.0;
};

class Elements {
 public:
  /// Corners and centres are for each of one or more time steps, equally spaced over the shutter,
  /// linear in between. All throw std::invalid_argument where there is no time step, a number is
  /// not finite, or the emission is out of range. Elements without an area are left out.
  void add_triangle(std::span<const std::array<Vec3, 3>> corners, const Emission& emission);
  /// corner, corner + edge_u, corner + edge_v.
  void add_parallelogram(std::span<const std::array<Vec3, 3>> corners, const Emission& emission);
  void add_sphere(std::span<const Sphere> spheres, const Emission& emission);
  /// Vertices for each time step, the same number; neighbouring triangles (a, b, c), (a, c, d) that
  /// are a parallelogram at all times become one element.
  void add_mesh(std::span<const std::span<const Vec3>> vertices,
                std::span<const std::array<std::uint32_t, 3>> triangles, const Emission& emission);

  /// Scales the weights of the elements from `first` on so that they add up to `weight`.
  void share_weight(std::size_t first, double weight);

  std::size_t size() const { return entries_.size(); }
  const ElementBounds& bounds(std::size_t i) const { return entries_[i].bounds; }
  double total_weight() const;

  std::optional<DrawnDirection> sample(std::size_t i, const LightSamplingContext& from, float u1,
                                       float u2) const {
    const Entry& entry = entries_[i];
    if (entry.kind == Kind::kPatch) return patches_[entry.first].sample(from.position, u1, u2);
    if (entry.kind == Kind::kBall) return balls_[entry.first].sample(from.position, u1, u2);
    return sample_moving(entry, from, u1, u2);
  }
  /// The same, with what the direction finds.
  std::optional<ElementSample> draw(std::size_t i, const LightSamplingContext& from, float u1,
                                    float u2) const {
    const Entry& entry = entries_[i];
    if (entry.kind == Kind::kPatch) return patches_[entry.first].draw(from.position, u1, u2);
    if (entry.kind == Kind::kBall) return balls_[entry.first].draw(from.position, u1, u2);
    return draw_moving(entry, from, u1, u2);
  }
  float pdf(std::size_t i, const LightSamplingContext& from, Vec3 direction) const {
    return along(i, from, direction).pdf;
  }
  OnHalfLine along(std::size_t i, const LightSamplingContext& from, Vec3 direction) const {
    const Entry& entry = entries_[i];
    if (entry.kind == Kind::kPatch) return patches_[entry.first].along(from.position, direction);
    if (entry.kind == Kind::kBall) return balls_[entry.first].along(from.position, direction);
    return moving_along(entry, from, direction);
  }
  ElementPoint point_at(std::size_t i, const LightSamplingContext& from, Vec3 direction,
                        float distance) const;
  std::uint32_t luminaire(std::size_t i) const { return entries_[i].luminaire; }
  bool is_ball_at_rest(std::size_t i) const { return entries_[i].kind == Kind::kBall; }

 private:
  enum class Kind : std::uint8_t { kPatch, kBall, kMovingPatch, kMovingBall };
  // Its `steps` states from `first` on in patches_ or balls_.
  struct Entry {
    Kind kind;
    std::uint32_t first, steps;
    std::uint32_t luminaire;
    ElementBounds bounds;
  };

  void add_patch(std::span<const std::array<Vec3, 3>> corners, bool triangle,
                 const Emission& emission);
  Patch patch_at(const Entry& entry, float time) const;
  Ball ball_at(const Entry& entry, float time) const;
  std::optional<DrawnDirection> sample_moving(const Entry& entry, const LightSamplingContext& from,
                                              float u1, float u2) const;
  std::optional<ElementSample> draw_moving(const Entry& entry, const LightSamplingContext& from,
                                           float u1, float u2) const;
  OnHalfLine moving_along(const Entry& entry, const LightSamplingContext& from,
                          Vec3 direction) const;

  std::vector<Entry> entries_;
  std::vector<Patch> patches_;
  std::vector<Ball> balls_;
};

}  // namespace nocturne

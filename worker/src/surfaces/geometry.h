// The scene's shapes in a bounding volume hierarchy. Embree does the search; only geometry.cpp and
// embree_callbacks know it.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "math/ray.h"
#include "surfaces/hit.h"
#include "surfaces/instance.h"
#include "surfaces/shapes.h"
#include "surfaces/surface_detail.h"

namespace nocturne {

/// A ray at a time within the shutter, [0, 1], up to a distance.
struct TimedRay {
  Ray ray;
  float time;
  float end = std::numeric_limits<float>::infinity();
};

class Geometry {
 public:
  /// Shape i becomes surface i. Throws std::runtime_error where Embree can't build.
  explicit Geometry(std::vector<Shape> shapes);
  /// groups[i] is the group of shape i: 0 stands in the scene itself, all others are shown by
  /// instances only. Throws also std::invalid_argument: instances of group 0 or of an empty group,
  /// and what PlacedInstance says.
  Geometry(std::vector<Shape> shapes, std::vector<std::uint32_t> groups,
           std::vector<Instance> instances);
  ~Geometry();
  Geometry(Geometry&&) noexcept;
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;

  /// The nearest hit in front of the origin, at a time within the shutter, [0, 1]. Safe from any
  /// number of threads.
  std::optional<Hit> intersect(const Ray& ray, float time) const;

  /// The same for many: what is found for a ray does not depend on the others.
  void intersect(std::span<const TimedRay> rays, std::span<std::optional<Hit>> hits) const;

  /// 1 where there is anything in front of the origin, nearer than the ray's end, else 0.
  void occluded(std::span<const TimedRay> rays, std::span<std::uint8_t> blocked) const;

  /// Other hits of a hit's ray, at the same time, no further from it than `reach` metres along the
  /// ray. Returns how many there are in `found`: the first, if it has not room for all.
  std::size_t others_near(const Ray& ray, float time, const Hit& hit, float reach,
                          std::span<Hit> found) const;

  /// What is more to say about a hit, at the time at which it was found.
  SurfaceDetail detail(const Hit& hit, float time) const;

  /// A sphere that holds everything, at all times.
  struct Ball {
    Vec3 centre;
    float radius;
  };
  Ball bounds() const;

  std::span<const Shape> shapes() const;
  /// In the order given.
  std::span<const PlacedInstance> instances() const;

  /// What searches: the library's version and how it is set up, as they decide which hit is found.
  static std::string library();

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace nocturne

// The scene's shapes in Embree's bounding volume hierarchy: rays in packets (packets), and one by
// one where surfaces are met in exact order (exact_search). Embree is known in this folder alone.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "math/ray.h"
#include "surfaces/departure.h"
#include "surfaces/exact_crossing.h"
#include "surfaces/hit.h"
#include "surfaces/instance.h"
#include "surfaces/shapes.h"
#include "surfaces/surface_detail.h"

namespace nocturne {

struct EmbreeScene;

/// A ray at a time within the shutter, [0, 1], up to a distance.
struct TimedRay {
  Ray ray;
  float time;
  float end = std::numeric_limits<float>::infinity();
  /// Null for one that starts at its origin, off the surface it left.
  const Departure* departure = nullptr;
};

/// One of the surfaces that a line crosses close together.
struct NearCrossing {
  Hit hit;
  ExactCrossing at;
  /// Lies where the first of them does.
  bool touches_first;
};

/// How rays of a list lie to their neighbours in it: only what a query costs depends on it.
enum class RayCoherence { kIncoherent, kCoherent };

class Geometry {
 public:
  /// Shape i becomes surface i. Throws std::runtime_error where Embree can't build.
  explicit Geometry(std::vector<Shape> shapes);
  /// groups[i] is the group of shape i: 0 stands in the scene itself, all others are shown by
  /// instances only. Throws also std::invalid_argument: instances of group 0 or of an empty group,
  /// and what PlacedInstance says; std::runtime_error soon after a stop is requested.
  Geometry(std::vector<Shape> shapes, std::vector<std::uint32_t> groups,
           std::vector<Instance> instances, std::stop_token stop = {});
  ~Geometry();
  Geometry(Geometry&&) noexcept;
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;

  /// The surfaces close to each surface; to be set once, before rays are traced. Until then nothing
  /// is close to anything.
  void set_close(std::vector<CloseSurface> close);
  const CloseSurface& close(std::uint32_t surface) const;
  /// Whether anything is close to anything.
  bool any_close() const;

  /// The nearest hit in front of the origin, at a time within the shutter, [0, 1]. Safe from any
  /// number of threads.
  std::optional<Hit> intersect(const Ray& ray, float time) const;
  /// The same for a ray from where something was left; only the surface it left itself, and those
  /// that touch that, are left out.
  std::optional<Hit> intersect(const Ray& ray, float time, const Departure& departure) const;

  /// The same for many: the result for a ray does not depend on the others.
  void intersect(std::span<const TimedRay> rays, std::span<std::optional<Hit>> hits) const;

  /// A ray that leaves a hit: from its point itself where anything is close to the surface, else
  /// from a little off it.
  DepartingRay depart(const Hit& hit, Vec3 direction, float time) const;

  /// 1 where there is anything in front of the origin, nearer than the ray's end, else 0.
  void occluded(std::span<const TimedRay> rays, std::span<std::uint8_t> blocked,
                RayCoherence coherence = RayCoherence::kIncoherent) const;

  /// What a hit's ray crosses, at the same time, no further from the hit than `reach` metres along
  /// the ray, in exact order; mostly the hit is among them, though slightly off an edge it need
  /// not be. Returns how many there are in `found`: the first, if it has not room for all.
  std::size_t crossings_near(const Ray& ray, float time, const Departure& departure, const Hit& hit,
                             float reach, std::span<NearCrossing> found) const;

  /// The further properties of a hit, at the time at which it was found.
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
  std::unique_ptr<EmbreeScene> embree_;
};

}  // namespace nocturne

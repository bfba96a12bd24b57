// The scene's shapes in a bounding volume hierarchy. Embree does the search; only geometry.cpp
// knows it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "math/ray.h"
#include "surfaces/hit.h"
#include "surfaces/shapes.h"

namespace nocturne {

/// A triangle on a half-line: its distance, and the cosine between its normal and the direction
/// (absolute value).
struct TriangleCrossing {
  std::uint32_t shape;
  float distance, cosine;
};

class Geometry {
 public:
  /// What will be asked: crossings cost every other query a check, so a tree answers them only
  /// where it is built for it.
  enum class Queries { kNearest, kCrossings };

  /// Shape i becomes surface i. Throws std::runtime_error where Embree can't build.
  explicit Geometry(std::vector<Shape> shapes, Queries queries = Queries::kNearest);
  ~Geometry();
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;

  /// The nearest hit in front of the origin. Safe from any number of threads.
  std::optional<Hit> intersect(const Ray& ray) const;

  /// True where something lies between the origin and `distance` along the ray.
  bool occluded(const Ray& ray, float distance) const;

  /// Needs Queries::kCrossings. Calls `visit` once for every triangle that the half-line meets, in
  /// any order.
  void for_each_triangle_crossing(const Ray& ray,
                                  const std::function<void(const TriangleCrossing&)>& visit) const;

  std::span<const Shape> shapes() const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace nocturne

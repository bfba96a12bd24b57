// The density over directions that points at luminaires: one of their elements (triangle,
// parallelogram or sphere) is chosen by area times mean radiance, then a point on it. As the
// density of a direction adds up every element on the half-line, hidden ones too, it is exact
// whatever stands between: a lamp behind glass is no special case.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "luminaires/luminaire.h"
#include "surfaces/geometry.h"

namespace nocturne {

class LuminaireDirections {
 public:
  /// The shapes are those of the scene, indexed by Luminaire::surface. Copies what it needs.
  LuminaireDirections(std::span<const Luminaire> luminaires, std::span<const Shape> shapes);

  bool empty() const { return cumulative_.empty(); }

  /// A unit direction from `position`; three uniform numbers. Empty where the drawn element has no
  /// extent from there.
  std::optional<Vec3> sample(Vec3 position, float choice, float u1, float u2) const;

  /// Density of `sample`, 1/sr.
  float pdf(Vec3 position, Vec3 direction) const;

 private:
  // corner + u edge_u + v edge_v; u, v in [0, 1], for a triangle also u + v <= 1.
  struct Patch {
    Vec3 corner, edge_u, edge_v;
    Vec3 normal;          // edge_u x edge_v
    Vec3 dual_u, dual_v;  // u = q . dual_u for q in the plane, from the corner
    float normal_length;
    float area_density;  // choice probability per area, 1/m2
    bool triangle;

    float pdf(Vec3 position, Vec3 direction) const;
  };
  struct Ball {
    Sphere sphere;
    float probability;
  };

  void add_mesh(const TriangleMesh& mesh, float weight_per_area);
  void add_patch(Vec3 corner, Vec3 edge_u, Vec3 edge_v, bool triangle, float weight_per_area);
  void add_ball(const Sphere& sphere, float weight_per_area);
  void normalise_weights();
  void index_patches(std::span<const Luminaire> luminaires, std::span<const Shape> shapes);

  // Elements in this order: patches, then balls.
  std::vector<Patch> patches_;
  std::vector<Ball> balls_;
  std::vector<double> weights_;  // only while building
  double total_ = 0.0;           // their sum
  std::vector<float> cumulative_;
  // Where there are many patches: their own tree, and the area density of each of its shapes.
  std::unique_ptr<Geometry> tree_;
  std::vector<float> tree_density_;
};

}  // namespace nocturne

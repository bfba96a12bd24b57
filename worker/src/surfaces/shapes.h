// Geometry as a scene holds it, in metres.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "math/double3.h"
#include "math/vec3.h"

namespace nocturne {

/// Front faces are counter-clockwise. Indices and counts are checked by whoever fills it.
struct TriangleMesh {
  /// All vertices of the first time step, then all of the next (time_steps.h).
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// Unit, for shading; one for each of `vertices`, or empty.
  std::vector<Vec3> normals = {};
  /// (u, v), one for each vertex of a time step, or empty.
  std::vector<std::array<float, 2>> texture_coordinates = {};
  std::uint32_t time_steps = 1;

  std::size_t vertex_count() const { return vertices.size() / time_steps; }
};

/// The parallelogram corner + s edge_u + t edge_v, 0 <= s, t <= 1, with texture coordinates (s, t).
/// Its normal is edge_u x edge_v.
inline TriangleMesh quad_mesh(Vec3 corner, Vec3 edge_u, Vec3 edge_v) {
  return {.vertices = {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v},
          .triangles = {{0, 1, 2}, {0, 2, 3}},
          .texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
}

/// Texture coordinates: u is the azimuth about z, from x towards y, over 2 pi; v the angle from -z
/// over pi, so that a picture stands upright on it where z is up.
struct Sphere {
  /// Centre at the first time.
  double x, y, z, radius;
  /// At further time steps; empty: at rest.
  std::vector<Double3> later_centres = {};
};

using Shape = std::variant<TriangleMesh, Sphere>;

/// Answers of the function that takes the shape's type. There is one for each: who asks does not
/// compile before a further type has its answer.
template <class S, class... F>
decltype(auto) visit_shape(S& shape, const F&... functions) {
  struct Each : F... {
    using F::operator()...;
  };
  return std::visit(Each{functions...}, shape);
}

inline std::size_t time_steps_of(const Shape& shape) {
  return visit_shape(
      shape, [](const TriangleMesh& mesh) { return std::size_t{mesh.time_steps}; },
      [](const Sphere& sphere) { return sphere.later_centres.size() + 1; });
}

/// Null where it is none, or moves by itself.
inline const TriangleMesh* mesh_at_rest(const Shape& shape) {
  return visit_shape(
      shape, [](const TriangleMesh& mesh) { return mesh.time_steps == 1 ? &mesh : nullptr; },
      [](const Sphere&) { return static_cast<const TriangleMesh*>(nullptr); });
}

/// What a search looks at one by one.
inline std::size_t primitive_count(const Shape& shape) {
  return visit_shape(
      shape, [](const TriangleMesh& mesh) { return mesh.triangles.size(); },
      [](const Sphere&) { return std::size_t{1}; });
}

}  // namespace nocturne

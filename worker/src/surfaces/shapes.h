// Geometry as a scene holds it, in metres.
#pragma once

#include <array>
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

}  // namespace nocturne

// Shapes, directions and matrices for the tests of geometry. Random numbers are philox with fixed
// keys.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>

#include "math/double3.h"
#include "pdfs/directions.h"
#include "sampling/philox.h"
#include "sampling/sequence.h"
#include "surfaces/instance.h"
#include "surfaces/shapes.h"

namespace nocturne::test {

/// Closed, normals outwards.
inline TriangleMesh box(float half, Vec3 centre) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        centre + half * Vec3{i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Four uniform numbers in [0, 1).
inline std::array<float, 4> any_numbers(std::uint32_t i, std::uint32_t stream = 0) {
  const auto words = philox4x32({i, 4, 5, 6}, {7, 8 + stream});
  return {to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])};
}

inline Vec3 any_direction(std::uint32_t i, std::uint32_t stream = 0) {
  const auto u = any_numbers(i, stream);
  return direction_from_z(1.0f - 2.0f * u[0], u[1]);
}

/// In the cube [-1, 1]^3.
inline Vec3 any_point(std::uint32_t i, std::uint32_t stream = 0) {
  const auto u = any_numbers(i, stream);
  return {2.0f * u[0] - 1.0f, 2.0f * u[1] - 1.0f, 2.0f * u[2] - 1.0f};
}

/// Scales along the group's axes, then a rotation by an angle about an axis (Rodrigues), then a
/// translation.
inline Transform transform(Double3 scale, Double3 axis, double angle, Double3 translation) {
  const Double3 k = (1.0 / length(axis)) * axis;
  const auto turned = [&](Double3 v) {
    return std::cos(angle) * v + std::sin(angle) * cross(k, v) +
           (1.0 - std::cos(angle)) * dot(k, v) * k;
  };
  const Double3 x = turned({scale.x, 0, 0}), y = turned({0, scale.y, 0}),
                z = turned({0, 0, scale.z});
  return {x.x, y.x, z.x, translation.x, x.y, y.y, z.y, translation.y, x.z, y.z, z.z, translation.z};
}

inline Double3 apply(const Transform& t, Double3 p) {
  return {t[0] * p.x + t[1] * p.y + t[2] * p.z + t[3], t[4] * p.x + t[5] * p.y + t[6] * p.z + t[7],
          t[8] * p.x + t[9] * p.y + t[10] * p.z + t[11]};
}

/// The mesh with its vertices moved, rounded once.
inline TriangleMesh moved(TriangleMesh mesh, const Transform& t) {
  for (Vec3& v : mesh.vertices) v = test::apply(t, v).rounded();
  return mesh;
}

/// A lumpy closed surface around the origin, about 1 in radius, with vertex normals and texture
/// coordinates: a grid of `rows` x 2 `rows` quads of longitude and latitude, two triangles each.
inline TriangleMesh lumpy_ball(int rows) {
  TriangleMesh mesh;
  const auto radius = [](double theta, double phi) {
    return 1.0 + 0.2 * std::sin(3.0 * theta) * std::cos(2.0 * phi);
  };
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j <= 2 * rows; ++j) {
      const double v = static_cast<double>(i) / rows, u = static_cast<double>(j) / (2 * rows);
      const double theta = std::numbers::pi * v, phi = 2.0 * std::numbers::pi * u;
      const Double3 n{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                      std::cos(theta)};
      mesh.vertices.push_back((radius(theta, phi) * n).rounded());
      mesh.normals.push_back(n.rounded());
      mesh.texture_coordinates.push_back({static_cast<float>(u), static_cast<float>(v)});
    }
  }
  const auto width = static_cast<std::uint32_t>(2 * rows + 1);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(rows); ++i) {
    for (std::uint32_t j = 0; j + 1 < width; ++j) {
      const std::uint32_t a = i * width + j, b = a + width;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return mesh;
}

}  // namespace nocturne::test

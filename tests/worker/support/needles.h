// Triangles that are long and thin, as of fans and scanned meshes.
#pragma once

#include <cmath>
#include <numbers>

#include "surfaces/shapes.h"

namespace nocturne::test {

/// A closed double cone about the z axis: tips at z = 1 and -1, `count` corners on a ring of radius
/// 1 between them, seen from inside. Triangle 2 i is the one from corner i on to the upper tip.
inline TriangleMesh needles(std::uint32_t count) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 1}, {0, 0, -1}};
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / count;
    mesh.vertices.push_back(
        {static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn)), 0.0f});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t one = 2 + i, other = 2 + (i + 1) % count;
    mesh.triangles.push_back({0, other, one});
    mesh.triangles.push_back({1, one, other});
  }
  return mesh;
}

}  // namespace nocturne::test

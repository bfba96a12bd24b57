// A triangle's corners, and the values interpolated between them, at one time.
#pragma once

#include "math/time_steps.h"
#include "surfaces/shapes.h"

namespace nocturne {

struct Corners {
  Vec3 a, b, c;
};

/// Of a vertex of a mesh that moves; `values` as in corners_at.
inline Vec3 vertex_at(const TriangleMesh& mesh, const std::vector<Vec3>& values,
                      const TimeSegment& segment, std::size_t vertex) {
  const std::size_t count = mesh.vertex_count(), first = segment.first * count;
  const Vec3 from = values[first + vertex], to = values[first + count + vertex];
  return (1.0f - segment.fraction) * from + segment.fraction * to;  // as Embree has it
}

/// From `values`, which hold a value for each vertex, time step by time step.
inline Corners corners_at(const TriangleMesh& mesh, const std::vector<Vec3>& values,
                          std::uint32_t triangle, float time) {
  const auto& t = mesh.triangles[triangle];
  if (mesh.time_steps == 1) return {values[t[0]], values[t[1]], values[t[2]]};
  const TimeSegment segment = segment_at(time, mesh.time_steps);
  return {vertex_at(mesh, values, segment, t[0]), vertex_at(mesh, values, segment, t[1]),
          vertex_at(mesh, values, segment, t[2])};
}

}  // namespace nocturne

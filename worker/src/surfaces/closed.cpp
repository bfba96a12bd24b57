#include "surfaces/closed.h"

#include <bit>
#include <cstdint>

#include "math/double3.h"
#include "math/splitmix64.h"

namespace nocturne {
namespace {

// -0 is 0.
std::uint64_t hash_of(Vec3 p) {
  const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0f)}; };
  return splitmix64(splitmix64(bits(p.x) << 32 | bits(p.y)) + bits(p.z));
}

// Opposite numbers for the two directions of an edge: they add up to nothing.
std::uint64_t directed(std::uint64_t from, std::uint64_t to) {
  return splitmix64(from + splitmix64(to)) - splitmix64(to + splitmix64(from));
}

bool is_closed_mesh(const TriangleMesh& mesh) {
  std::uint64_t sum = 0;
  double volume = 0.0;  // six times that, above 0 where normals point out
  const Double3 origin(mesh.vertices.empty() ? Vec3{} : mesh.vertices[0]);
  const auto from_origin = [&](std::uint32_t i) { return Double3(mesh.vertices[i]) - origin; };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint64_t at_a = hash_of(mesh.vertices[a]), at_b = hash_of(mesh.vertices[b]),
                        at_c = hash_of(mesh.vertices[c]);
    sum += directed(at_a, at_b) + directed(at_b, at_c) + directed(at_c, at_a);
    volume += dot(from_origin(a), cross(from_origin(b), from_origin(c)));
  }
  return sum == 0 && volume > 0.0;
}

}  // namespace

bool is_closed(const Shape& shape) {
  return visit_shape(
      shape, [](const TriangleMesh& mesh) { return is_closed_mesh(mesh); },
      [](const Sphere&) { return true; });
}

}  // namespace nocturne

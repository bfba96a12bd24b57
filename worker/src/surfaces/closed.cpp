#include "surfaces/closed.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace nocturne {
namespace {

// Of splitmix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA
// 2014), with the constants of Stafford's mix 13.
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
  x = (x ^ x >> 27) * 0x94D049BB133111EBu;
  return x ^ x >> 31;
}

// -0 is 0.
std::uint64_t hash_of(Vec3 p) {
  const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0f)}; };
  return mix(mix(bits(p.x) << 32 | bits(p.y)) + bits(p.z));
}

// Opposite numbers for an edge one way and the other: they add up to nothing.
std::uint64_t directed(std::uint64_t from, std::uint64_t to) {
  return mix(from + mix(to)) - mix(to + mix(from));
}

}  // namespace

bool is_closed(const Shape& shape) {
  const auto* mesh = std::get_if<TriangleMesh>(&shape);
  if (mesh == nullptr) return true;
  std::uint64_t sum = 0;
  for (const auto& [a, b, c] : mesh->triangles) {
    const std::uint64_t at_a = hash_of(mesh->vertices[a]), at_b = hash_of(mesh->vertices[b]),
                        at_c = hash_of(mesh->vertices[c]);
    sum += directed(at_a, at_b) + directed(at_b, at_c) + directed(at_c, at_a);
  }
  return sum == 0;
}

}  // namespace nocturne

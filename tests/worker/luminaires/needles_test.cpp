// Long and thin triangles as something to point at: each direction is one to one of them, and what
// is drawn ends before it.
#include "support/needles.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "luminaires/elements.h"
#include "sampling/sequence.h"
#include "surfaces/triangle_at.h"

namespace nocturne {
namespace {

constexpr std::uint32_t kNeedles = 100'000;
constexpr LightSamplingContext kFrom{{0.1f, 0.05f, 0.02f}, {0, 0, 1}, true};

Uniform4 numbers(std::uint32_t i) {
  return to_unit(std::bit_cast<__m128i>(philox4x32({i, 0, 0, 0}, {7, 8})));
}

struct Cone {
  TriangleMesh mesh = test::needles(kNeedles);
  Elements elements;

  Cone() {
    const std::vector<std::span<const Vec3>> vertices{mesh.vertices};
    elements.add_mesh(vertices, mesh.triangles, {1.0f});
  }
};

TEST(Needles, NeighboursAreOnEachHalfLineOnce) {
  const Cone cone;
  int found = 0;
  constexpr int kDraws = 3000;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const Uniform4 u = numbers(i);
    const auto chosen = static_cast<std::uint32_t>(u[0] * kNeedles);
    const auto drawn = cone.elements.draw(2 * chosen, kFrom, u[1], u[2]);
    ASSERT_TRUE(drawn);
    // A direction is a float: it may be one to a neighbour.
    for (std::uint32_t k = kNeedles - 3; k <= kNeedles + 3; ++k) {
      const std::uint32_t needle = 2 * ((chosen + k) % kNeedles);
      found += cone.elements.pdf(needle, kFrom, drawn->direction) > 0.0f ? 1 : 0;
    }
  }
  EXPECT_EQ(found, kDraws);
}

TEST(Needles, ADrawnWayEndsInFrontOfTheNeedle) {
  const Cone cone;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const Uniform4 u = numbers(i);
    const auto chosen = static_cast<std::uint32_t>(u[0] * kNeedles);
    const auto drawn = cone.elements.draw(2 * chosen, kFrom, u[1], u[2]);
    ASSERT_TRUE(drawn);
    const Corners p = corners_at(cone.mesh, cone.mesh.vertices, 2 * chosen, 0.0f);
    const Double3 n = cross(Double3(p.b) - Double3(p.a), Double3(p.c) - Double3(p.a));
    const Double3 unit = (1.0 / length(n)) * n, from(kFrom.position), d(drawn->direction);
    const double cosine = dot(unit, d), way = dot(unit, Double3(p.a) - from) / cosine;
    for (const float distance :
         {drawn->distance, cone.elements.along(2 * chosen, kFrom, d.rounded()).distance}) {
      if (std::isinf(distance)) continue;  // beside it
      EXPECT_LT(std::fabs((distance - way) * cosine), drawn->point.clearance);
    }
    EXPECT_LT(length(Double3(drawn->point.normal) - unit), 1e-6);
  }
}

}  // namespace
}  // namespace nocturne

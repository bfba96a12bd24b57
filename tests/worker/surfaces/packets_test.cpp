// Rays in packets have the same hits as alone, bit for bit, whatever rays they are with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pdfs/directions.h"
#include "surfaces/geometry.h"
#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

TriangleMesh hills(int cells) {
  TriangleMesh mesh;
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      const float u = 2.0f * static_cast<float>(x) / static_cast<float>(cells) - 1.0f;
      const float v = 2.0f * static_cast<float>(y) / static_cast<float>(cells) - 1.0f;
      mesh.vertices.push_back({u, v, 0.3f * std::sin(9.0f * u) * std::cos(7.0f * v)});
    }
  }
  const auto row = static_cast<std::uint32_t>(cells + 1);
  for (std::uint32_t y = 0; y + 1 < row; ++y) {
    for (std::uint32_t x = 0; x + 1 < row; ++x) {
      const std::uint32_t a = y * row + x;
      mesh.triangles.push_back({a, a + 1, a + row + 1});
      mesh.triangles.push_back({a, a + row + 1, a + row});
    }
  }
  return mesh;
}

// Triangles, spheres at rest and moving, and instances of all of them, moving too.
Geometry everything() {
  Sphere moving{0.5, -0.5, 0.8, 0.2, {{0.7, -0.3, 0.9}}};
  std::vector<Shape> shapes{
      hills(40), Sphere{0.2, 0.1, 0.7, 0.25}, Sphere{-0.6, 0, 0.5, 0.1}, moving,
      hills(8),  Sphere{0, 0, 0.5, 0.3}};
  const Transform small{0.3, 0, 0, -0.5, 0, 0.3, 0, 0.5, 0, 0, 0.3, 0.9};
  Transform later = small;
  later[3] = -0.3;
  return {std::move(shapes), {0, 0, 0, 0, 1, 1}, {{1, {small}}, {1, {small, later}}}};
}

std::vector<TimedRay> rays(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  std::vector<TimedRay> all;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 origin{2 * u(random) - 1, 2 * u(random) - 1, 2 * u(random) - 0.5f};
    all.push_back({{origin, UniformSphere::sample(u(random), u(random))}, u(random)});
  }
  return all;
}

void expect_same(const std::optional<Hit>& a, const std::optional<Hit>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->position, b->position);
  EXPECT_EQ(a->normal, b->normal);
  EXPECT_EQ(a->distance, b->distance);
  EXPECT_EQ(a->surface, b->surface);
  EXPECT_EQ(a->instance, b->instance);
  EXPECT_EQ(a->primitive, b->primitive);
  EXPECT_EQ(a->u, b->u);
  EXPECT_EQ(a->v, b->v);
}

TEST(Packets, FindWhatSingleRaysFind) {
  const Geometry geometry = everything();
  const auto all = rays(20'003);
  std::vector<std::optional<Hit>> hits(all.size());
  geometry.intersect(all, hits);
  std::size_t met = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    expect_same(hits[i], geometry.intersect(all[i].ray, all[i].time));
    met += hits[i].has_value();
  }
  EXPECT_GT(met, all.size() / 4);
  EXPECT_LT(met, all.size());
}

TEST(Packets, NeighboursDoNotMatter) {
  const Geometry geometry = everything();
  auto all = rays(8'000);
  std::vector<std::optional<Hit>> hits(all.size()), shuffled_hits(all.size());
  geometry.intersect(all, hits);
  std::vector<std::size_t> order(all.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  std::vector<TimedRay> shuffled;
  for (const std::size_t i : order) shuffled.push_back(all[i]);
  geometry.intersect(shuffled, shuffled_hits);
  for (std::size_t i = 0; i < order.size(); ++i) expect_same(shuffled_hits[i], hits[order[i]]);
}

// A ray is blocked just if its nearest hit is nearer than its end.
TEST(Packets, AreOccludedWhereTheyHit) {
  const Geometry geometry = everything();
  auto all = rays(20'000);
  std::vector<std::optional<Hit>> hits(all.size());
  geometry.intersect(all, hits);
  std::vector<std::uint8_t> blocked(all.size());
  geometry.occluded(all, blocked);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(blocked[i] != 0, hits[i].has_value());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (hits[i]) all[i].end = hits[i]->distance * (i % 2 == 0 ? 0.999f : 1.001f);
  }
  geometry.occluded(all, blocked);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(blocked[i] != 0, hits[i] && i % 2 == 1) << i;
  }
}

}  // namespace
}  // namespace nocturne

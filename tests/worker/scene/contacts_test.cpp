#include "scene/contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support/scene_builder.h"
#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

using test::any_direction;
using test::any_numbers;

constexpr std::uint32_t kAir = InteriorList::kOutside;

// The dielectrics that a straight line goes through, where nothing is refracted.
std::vector<std::uint32_t> bodies_on(const Scene& scene, const Ray& ray) {
  InteriorList inside;
  std::vector<std::uint32_t> met{kAir};
  DepartingRay from{ray, {}};
  for (int i = 0; i < 100; ++i) {
    auto hit = scene.geometry.intersect(from.ray, 0.0f, from.departure);
    if (!hit) break;
    const Contacts contacts = contacts_of(scene, from.ray, 0.0f, from.departure, *hit);
    const std::uint32_t body = scene.materials[hit->surface].interior;
    const Crossing own{body, dot(hit->normal, ray.direction) < 0.0f};
    inside = cross_boundary(inside, scene.interiors, own, contacts).beyond;
    if (inside.current(scene.interiors) != met.back()) {
      met.push_back(inside.current(scene.interiors));
    }
    from = scene.geometry.depart(*hit, ray.direction, 0.0f);
  }
  return met;
}

// Through the faces that three boxes share, at several places and sizes: always the one, then the
// other, and out.
TEST(Contacts, BodiesThatTouchFollowEachOther) {
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    for (const float offset : {0.0f, 10.0f}) {
      const Vec3 low{offset * size, 0.3f * offset * size, -offset * size};
      test::SceneBuilder builder;
      for (int i = 0; i < 3; ++i) {
        const Vec3 corner = low + Vec3{0, 0, static_cast<float>(i) * size};
        builder.add_glass_box(corner, low + Vec3{size, size, static_cast<float>(i + 1) * size},
                              1.2f + 0.1f * static_cast<float>(i));
      }
      const auto scene = builder.load();
      for (std::uint32_t i = 0; i < 3'000; ++i) {
        const auto u = any_numbers(i);
        const Vec3 from = low + size * Vec3{0.1f + 0.8f * u[0], 0.1f + 0.8f * u[1], -0.5f};
        const Vec3 to = low + size * Vec3{0.1f + 0.8f * u[2], 0.1f + 0.8f * u[3], 3.5f};
        ASSERT_EQ(bodies_on(*scene, {from, normalized(to - from)}),
                  (std::vector<std::uint32_t>{kAir, 0, 1, 2, kAir}))
            << "size " << size << " offset " << offset << " ray " << i;
      }
    }
  }
}

// A millimetre of air is a millimetre of air.
TEST(Contacts, OnlyWhatLiesInOnePlaceTouches) {
  test::SceneBuilder builder;
  builder.add_glass_box({-1, -1, -1}, {1, 1, 0}, 1.5f);
  builder.add_glass_box({-1, -1, 1e-3f}, {1, 1, 1}, 1.33f);
  const auto scene = builder.load();
  EXPECT_EQ(bodies_on(*scene, {{0.3f, 0.2f, 3}, {0, 0, -1}}),
            (std::vector<std::uint32_t>{kAir, 1, kAir, 0, kAir}));
}

// From something so wide photons start a metre off; from the box above it they do not.
TEST(Contacts, AWideFloorIsFarFromWhatStandsAboveIt) {
  test::SceneBuilder builder;
  builder.add_glass_box({-1, -1, -0.5f}, {1, 1, 0}, 1.5f);
  builder.add_quad(0.5f, 0.0f, {-1e6f, -1e6f, -1.5f}, {2e6f, 0, 0}, {0, 2e6f, 0});
  const auto scene = builder.load();
  const Ray down{{0.3f, 0.2f, 3}, {0, 0, -1}};
  auto hit = scene->geometry.intersect(down, 0.0f);
  ASSERT_TRUE(hit);
  const std::uint32_t top = hit->surface;
  EXPECT_TRUE(contacts_of(*scene, down, 0.0f, {}, *hit).empty());
  EXPECT_EQ(hit->surface, top);
}

TEST(Contacts, ASheetHidesTheBodyOnIt) {
  test::SceneBuilder builder;
  builder.add_glass_box({-1, -1, 0}, {1, 1, 1}, 1.5f);
  builder.add_quad(0.5f, 0.0f, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  auto& sheet = *builder.message.mutable_kernels()->rbegin()->mutable_diffuse_transmitter();
  sheet.mutable_reflectance()->set_spectrum(builder.add_spectrum(0.4f));
  sheet.mutable_transmittance()->set_spectrum(builder.add_spectrum(0.5f));
  const auto scene = builder.load();
  const std::uint32_t paper = 6;
  for (std::uint32_t i = 0; i < 1'000; ++i) {
    const auto u = any_numbers(i);
    Vec3 direction = any_direction(i, 1);
    const Vec3 at{u[0] - 0.5f, u[1] - 0.5f, 0.0f};
    if (std::fabs(direction.z) < 0.02f) continue;
    const Ray ray{at - 0.3f * direction, direction};
    auto hit = scene->geometry.intersect(ray, 0.0f);
    ASSERT_TRUE(hit);
    if (hit->distance < 0.29f) continue;  // of the glass, a side
    const Contacts contacts = contacts_of(*scene, ray, 0.0f, {}, *hit);
    ASSERT_EQ(hit->surface, paper);
    ASSERT_FALSE(contacts.empty());
    EXPECT_EQ(contacts.begin()->body, 0u);
    EXPECT_EQ(contacts.begin()->entering, direction.z > 0.0f);
  }
}

// The surfaces along a straight path.
std::vector<std::uint32_t> surfaces_on(const Scene& scene, DepartingRay from, std::size_t count) {
  std::vector<std::uint32_t> met;
  while (met.size() < count) {
    auto hit = scene.geometry.intersect(from.ray, 0.0f, from.departure);
    if (!hit) break;
    contacts_of(scene, from.ray, 0.0f, from.departure, *hit);
    met.push_back(hit->surface);
    from = scene.geometry.depart(*hit, from.ray.direction, 0.0f);
  }
  return met;
}

// It hides nothing of the glass that it lies on, and is met on the glass's outside.
TEST(Contacts, WhatLightPassesStraightLiesOutsideOfTheBody) {
  test::SceneBuilder builder;
  builder.add_glass_box({-1, -1, 0}, {1, 1, 1}, 1.5f);
  builder.add_quad(0.5f, 1.0f, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  builder.message.mutable_kernels()->rbegin()->mutable_null_kernel();
  const auto scene = builder.load();
  const std::uint32_t sheet = 6;
  for (std::uint32_t i = 0; i < 1'000; ++i) {
    const auto u = any_numbers(i);
    const Vec3 direction = any_direction(i, 1);
    const Vec3 at{u[0] - 0.5f, u[1] - 0.5f, 0.0f};
    if (std::fabs(direction.z) < 0.5f) continue;
    const auto met = surfaces_on(*scene, {{at - 0.3f * direction, direction}, {}}, 2);
    ASSERT_EQ(met.size(), 2u);
    EXPECT_EQ(met[direction.z > 0.0f ? 0 : 1], sheet) << direction.z;
    EXPECT_NE(met[0], met[1]);
    if (direction.z < 0.0f) continue;
    // What the glass mirrors passes it once more.
    auto mirror = scene->geometry.intersect({at + Vec3{0, 0, -0.3f}, {0, 0, 1}}, 0.0f);
    Hit face = *mirror;
    face.surface = met[1];
    const auto back = surfaces_on(*scene, scene->geometry.depart(face, -direction, 0.0f), 2);
    EXPECT_EQ(back, std::vector<std::uint32_t>{sheet});
  }
}

TEST(Contacts, NothingIsLookedForWithoutBodies) {
  test::SceneBuilder builder;
  builder.add_furnace(0.5f, 1.0f);
  const auto scene = builder.load();
  for (const SurfaceMaterial& material : scene->materials) EXPECT_FALSE(material.close);
}

// Spheres and instances are found as triangles are.
TEST(Contacts, OthersOfEveryKindAreFound) {
  const Transform same{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const Geometry geometry({test::box(1.0f, {}), Sphere{0, 0, 0, 1.0}, test::box(1.0f, {})},
                          {0, 0, 1}, {{1, {same}}});
  const Ray ray{{0.01f, 0.02f, 3}, {0, 0, -1}};
  const auto hit = geometry.intersect(ray, 0.0f);
  ASSERT_TRUE(hit);
  std::array<NearCrossing, 8> found;
  const std::size_t count = geometry.crossings_near(ray, 0.0f, {}, *hit, 1e-3f, found);
  ASSERT_EQ(count, 3u);
  std::vector<std::uint32_t> surfaces{found[0].hit.surface, found[1].hit.surface,
                                      found[2].hit.surface};
  std::ranges::sort(surfaces);
  EXPECT_EQ(surfaces, (std::vector<std::uint32_t>{0, 1, 2}));
  for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR(found[i].hit.position.z, 1.0, 1e-3);
  EXPECT_EQ(geometry.crossings_near(ray, 0.0f, {}, *hit, 1e-3f, std::span(found).first(1)), 1u);
}

}  // namespace
}  // namespace nocturne

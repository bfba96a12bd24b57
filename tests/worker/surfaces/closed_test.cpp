#include "surfaces/closed.h"

#include <gtest/gtest.h>

#include <utility>

#include "surfaces/test_shapes.h"

namespace nocturne {
namespace {

// Each triangle with its own corners, as meshes with normals by face have them.
TriangleMesh apart(const TriangleMesh& mesh) {
  TriangleMesh all;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    for (const std::uint32_t corner : triangle) all.vertices.push_back(mesh.vertices[corner]);
    all.triangles.push_back({first, first + 1, first + 2});
  }
  return all;
}

const TriangleMesh kBox = test::box(1.0f, {0.1f, 0.2f, 0.3f});

TEST(Closed, WhatHasAnInside) {
  EXPECT_TRUE(is_closed(Sphere{0, 0, 0, 1}));
  EXPECT_TRUE(is_closed(kBox));
  EXPECT_TRUE(is_closed(apart(kBox)));
  EXPECT_FALSE(is_closed(quad_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0})));
}

TEST(Closed, MinusZeroIsZero) {
  TriangleMesh box = apart(test::box(1.0f, {1.0f, 1.0f, 1.0f}));
  bool changed = false;
  for (Vec3& corner : box.vertices) {
    if (std::exchange(changed, !changed) && corner.x == 0.0f) corner.x = -0.0f;
  }
  EXPECT_TRUE(is_closed(box));
}

TEST(Closed, InsideOutItHasNoEnd) {
  TriangleMesh box = kBox;
  for (auto& triangle : box.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_FALSE(is_closed(box));
}

TEST(Closed, EveryTriangleIsNeeded) {
  for (std::size_t i = 0; i < kBox.triangles.size(); ++i) {
    TriangleMesh box = kBox;
    std::swap(box.triangles[i][0], box.triangles[i][1]);
    EXPECT_FALSE(is_closed(box)) << "turned: " << i;
    box.triangles.erase(box.triangles.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_FALSE(is_closed(box)) << "gone: " << i;
  }
}

}  // namespace
}  // namespace nocturne

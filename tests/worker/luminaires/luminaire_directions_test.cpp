#include "luminaires/luminaire_directions.h"

#include "support/chi_square.h"

namespace nocturne {
namespace {

// Tests see one luminaire or several from a point, through the whole sphere of directions.
void expect_consistent(std::vector<Shape> shapes, Vec3 position) {
  std::vector<Luminaire> luminaires;
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    luminaires.push_back({i, Spectrum(1.0f + static_cast<float>(i)), i % 2 == 1});
  }
  const LuminaireDirections directions(luminaires, shapes);
  test::expect_samples_match_pdf(
      [&](const Uniform4& u) { return directions.sample(position, u[1], u[2], u[3]); },
      [&](Vec3 w) { return directions.pdf(position, w); });
}

TriangleMesh one_triangle() {
  return {{{1.0f, -1.0f, 1.0f}, {1.5f, 2.0f, 0.5f}, {-1.0f, 0.5f, 2.0f}}, {{0, 1, 2}}};
}

TriangleMesh rectangle(float z) {
  return {{{-1, -1, z}, {1, -1, z}, {1, 1.5f, z}, {-1, 1.5f, z}}, {{0, 1, 2}, {0, 2, 3}}};
}

// A grid of triangles on a bowl: enough of them for the tree.
TriangleMesh bowl() {
  constexpr int kSide = 8;
  TriangleMesh mesh;
  for (int j = 0; j <= kSide; ++j) {
    for (int i = 0; i <= kSide; ++i) {
      const float x = 2.0f * static_cast<float>(i) / kSide - 1.0f,
                  y = 2.0f * static_cast<float>(j) / kSide - 1.0f;
      mesh.vertices.push_back({x, y, 1.0f + 0.4f * (x * x + y * y)});
    }
  }
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i, b = a + kSide + 1;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({a + 1, b + 1, b});
    }
  }
  return mesh;
}

TEST(LuminaireDirections, Triangle) { expect_consistent({one_triangle()}, {0.1f, 0.2f, -0.3f}); }

TEST(LuminaireDirections, RectangleIsOnePatch) {
  expect_consistent({rectangle(1.0f)}, {0.3f, 0.2f, 0.1f});
}

TEST(LuminaireDirections, SphereFromOutside) {
  expect_consistent({Sphere{1.0, 1.0, 1.0, 0.9}}, {0, 0, 0});
}

TEST(LuminaireDirections, SphereFromInside) {
  expect_consistent({Sphere{0.1, 0.0, 0.0, 2.0}}, {0, 0, 0});
}

TEST(LuminaireDirections, OneBehindAnotherAddUp) {
  expect_consistent(
      {rectangle(1.0f), rectangle(1.7f), Sphere{0.0, 0.0, 4.0, 1.0}, Sphere{0.0, -2.0, 0.0, 0.8}},
      {0.3f, 0.2f, 0.1f});
}

TEST(LuminaireDirections, ManyPatchesUseATree) {
  expect_consistent({bowl(), rectangle(2.5f)}, {0.1f, 0.1f, 0.0f});
}

// The tree is only faster: a patch more or less on the list must not change the density.
TEST(LuminaireDirections, TreeAndListAgree) {
  const TriangleMesh many = bowl();
  const std::vector<Luminaire> luminaire{{0, Spectrum(1.0f), false}};
  const LuminaireDirections tree(luminaire, std::vector<Shape>{many});
  double area = 0.0;
  std::vector<std::unique_ptr<LuminaireDirections>> lists;
  std::vector<double> areas;
  for (const auto& t : many.triangles) {
    const TriangleMesh single{{many.vertices[t[0]], many.vertices[t[1]], many.vertices[t[2]]},
                              {{0, 1, 2}}};
    lists.push_back(std::make_unique<LuminaireDirections>(luminaire, std::vector<Shape>{single}));
    areas.push_back(0.5 * length(cross(single.vertices[1] - single.vertices[0],
                                       single.vertices[2] - single.vertices[0])));
    area += areas.back();
  }
  for (std::uint32_t i = 0; i < 200; ++i) {
    const auto words = philox4x32({i, 1, 2, 3}, {1, 1});
    const Vec3 w = direction_from_z(0.3f + 0.7f * to_unit(words[0]), to_unit(words[1]));
    double sum = 0.0;
    for (std::size_t k = 0; k < lists.size(); ++k)
      sum += lists[k]->pdf({0, 0, 0}, w) * areas[k] / area;
    ASSERT_NEAR(tree.pdf({0, 0, 0}, w), sum, 1e-4 * sum + 1e-9);
  }
}

TEST(LuminaireDirections, DarkLuminairesAreNothingToPointAt) {
  const std::vector<Luminaire> dark{{0, Spectrum(0.0f), false}};
  const LuminaireDirections directions(dark, std::vector<Shape>{rectangle(1.0f)});
  EXPECT_TRUE(directions.empty());
  EXPECT_FALSE(directions.sample({0, 0, 0}, 0.5f, 0.5f, 0.5f));
}

}  // namespace
}  // namespace nocturne

#include "media/grid_density.h"

#include <gtest/gtest.h>

#include <cmath>

#include "grid_bytes.h"
#include "majorant_checks.h"
#include "pdfs/directions.h"

namespace nocturne {
namespace {

constexpr std::array<double, 12> kAsItIs{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

std::shared_ptr<const FloatGrid> shared(const std::vector<std::byte>& bytes) {
  return std::make_shared<const FloatGrid>(std::span(bytes));
}
GridField field(const std::vector<std::byte>& bytes, bool nearest = false,
                const std::array<double, 12>& transform = kAsItIs, double scale = 1.0) {
  return {shared(bytes), transform, scale, nearest};
}

// Noise with holes, and blocks of one value, small and large.
float cloud(int x, int y, int z) {
  if (x < 0 && y < 0) return 0.25f;
  if ((x >> 4) + (y >> 3) + (z >> 3) == 3) return 0.0f;
  const auto word = [](int v) { return static_cast<std::uint32_t>(v); };
  const auto u = test::media_numbers((word(x) * 7919u + word(y)) * 6007u + word(z), 31);
  return u[0] < 0.5f ? 0.0f : u[1];
}
const std::vector<std::byte>& cloud_bytes() {
  static const auto bytes = test::grid_bytes(cloud, {-140, -135, -30}, {60, 41, 50});
  return bytes;
}

TEST(FloatGrid, HoldsWhatWasPutIn) {
  const FloatGrid grid{std::span(cloud_bytes())};
  EXPECT_EQ(grid.background(), 0.0f);
  EXPECT_EQ(grid.size(), cloud_bytes().size());
  float majorant = 0.0f;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const auto u = test::media_numbers(i, 1);
    const int x = static_cast<int>(u[0] * 220.0f) - 150, y = static_cast<int>(u[1] * 200.0f) - 145,
              z = static_cast<int>(u[2] * 100.0f) - 40;
    const bool inside = x >= -140 && x <= 60 && y >= -135 && y <= 41 && z >= -30 && z <= 50;
    const float expected = inside ? cloud(x, y, z) : 0.0f;
    ASSERT_EQ(grid.value(x, y, z), expected);
    majorant = std::max(majorant, expected);
    const auto corners = grid.corners(x, y, z);
    for (int c = 0; c < 8; ++c) {
      ASSERT_EQ(corners[static_cast<std::size_t>(c)],
                grid.value(x + c / 4, y + c / 2 % 2, z + c % 2));
    }
  }
  EXPECT_GE(grid.majorant(), majorant);
  EXPECT_LE(grid.majorant(), 1.0f);
  // In whole blocks.
  EXPECT_EQ(grid.box().low, (std::array<std::int64_t, 3>{-144, -136, -32}));
  EXPECT_EQ(grid.box().high, (std::array<std::int64_t, 3>{63, 47, 55}));
}

TEST(GridField, AgreesWithNanoVdbsSamplers) {
  for (const bool nearest : {false, true}) {
    const GridField f = field(cloud_bytes(), nearest);
    const test::Sampler expected = test::sampler(cloud_bytes(), nearest);
    for (std::uint32_t i = 0; i < 100'000; ++i) {
      const auto u = test::media_numbers(i, 2);
      const Vec3 p{u[0] * 210.0f - 145.0f, u[1] * 185.0f - 140.0f, u[2] * 90.0f - 35.0f};
      const Double3 x(p);
      ASSERT_NEAR(f.at(p), expected(x.x, x.y, x.z), 2e-7) << i;
    }
  }
}

// Linear interpolation of a linear function is that function, in the scene's metres.
TEST(GridField, IsLinearBetweenVoxelsWhereverTheGridIs) {
  // Voxels of 1 cm, sheared and turned, far from the grid's origin; then into the scene.
  const std::array<double, 12> voxels{0.01, 0.002, 0.0, 100.0, -0.003, 0.0,
                                      0.01, 7.0,   0.0, 0.01,  0.0,    -50.0};
  const std::array<double, 12> scene{0.0, 2.0,    0.0, 3.0, 2.0, 0.0,
                                     0.0, -200.0, 0.0, 0.0, 2.0, 100.0};
  const auto f = field(test::grid_bytes(
                           [](int x, int y, int z) {
                             return 20.0f + 0.5f * static_cast<float>(x) -
                                    0.25f * static_cast<float>(y) + 0.125f * static_cast<float>(z);
                           },
                           {-10, -10, -10}, {20, 20, 20}, 0.0f, voxels),
                       false, scene, 2.0);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const auto u = test::media_numbers(i, 3);
    const double x = 29.0 * u[0] - 9.5, y = 29.0 * u[1] - 9.5, z = 29.0 * u[2] - 9.5;
    const double gx = 0.01 * x + 0.002 * y + 100.0, gy = -0.003 * x + 0.01 * z + 7.0,
                 gz = 0.01 * y - 50.0;
    const Vec3 p{static_cast<float>(2.0 * gy + 3.0), static_cast<float>(2.0 * gx - 200.0),
                 static_cast<float>(2.0 * gz + 100.0)};
    // Positions of about 20 in single precision, against voxels of 2 cm: 1e-4 of a voxel.
    ASSERT_NEAR(f.at(p), 2.0 * (20.0 + 0.5 * x - 0.25 * y + 0.125 * z), 5e-4) << i;
  }
}

TEST(GridField, NearestIsConstantOverAVoxel) {
  const auto f =
      field(test::grid_bytes([](int x, int, int) { return 1.0f + 0.5f * static_cast<float>(x); },
                             {0, 0, 0}, {7, 7, 7}),
            true);
  EXPECT_EQ(f.at({2.51f, 3, 3}), 2.5f);
  EXPECT_EQ(f.at({3.49f, 3, 3}), 2.5f);
  EXPECT_EQ(f.at({3.51f, 3, 3}), 3.0f);
  EXPECT_EQ(f.at({-0.49f, 3, 3}), 1.0f);
  EXPECT_EQ(f.at({-0.51f, 3, 3}), 0.0f);
  EXPECT_EQ(f.at({7.49f, 3, 3}), 4.5f);
  EXPECT_EQ(f.at({7.51f, 3, 3}), 0.0f);
}

TEST(GridField, BeyondTheGridIsItsBackground) {
  const auto bytes =
      test::grid_bytes([](int, int, int) { return 5.0f; }, {0, 0, 0}, {3, 3, 3}, 0.5f);
  const auto f = field(bytes, false, kAsItIs, 2.0);
  EXPECT_EQ(f.at({1, 1, 1}), 10.0f);
  EXPECT_EQ(f.at({-0.5f, 1, 1}), 5.5f);
  for (const float far : {-1.0f, 50.0f, 1e30f, HUGE_VALF, std::nanf("")}) {
    EXPECT_EQ(f.at({far, 1, 1}), 1.0f);
  }
}

struct Placed {
  const char* name;
  std::array<double, 12> transform;
  float size;
};
const Placed kPlaced[]{{"as it is", kAsItIs, 200.0f},
                       {"millimetres", {1e-3, 0, 0, 0.5, 0, 0, 1e-3, 0.1, 0, -2e-3, 0, 0.2}, 0.3f},
                       {"sheared", {0.3, 0.1, 0, 2, -0.1, 0.2, 0.1, 3, 0.05, 0, 0.4, -4}, 60.0f},
                       // Voxels of 10 cm ten kilometres away, where single precision steps by 1 mm.
                       {"far", {0.1, 0, 0, 10000.0005, 0, 0.1, 0, -1e4, 0, 0, 0.1, 1e4}, 8.0f}};

TEST(GridMajorants, HoldOnAnyRay) {
  const auto ball = test::grid_bytes(
      [](int x, int y, int z) {
        const float r = std::sqrt(static_cast<float>(x * x + y * y + z * z));
        return std::max(0.0f, 1.0f - r / 40.0f);
      },
      {-40, -40, -40}, {40, 40, 40});
  const auto around = test::grid_bytes(cloud, {0, 0, 0}, {40, 40, 40}, 0.125f);
  // Starts just beyond what the first cells interpolate: only rounding gets there from within.
  const auto wall =
      test::grid_bytes([](int x, int y, int z) { return x >= 9 && y >= 9 && z >= 9 ? 1.0f : 0.0f; },
                       {0, 0, 0}, {40, 40, 40});
  std::uint32_t i = 0;
  for (const auto* bytes : {&cloud_bytes(), &ball, &around, &wall}) {
    for (const bool nearest : {false, true}) {
      for (const Placed& placed : kPlaced) {
        for (const std::int64_t cell : {8, 16, 64}) {
          const GridDensity density(field(*bytes, nearest, placed.transform, 3.0), cell);
          const auto& t = placed.transform;
          const Vec3 centre{static_cast<float>(t[3]), static_cast<float>(t[7]),
                            static_cast<float>(t[11])};
          for (int ray = 0; ray < 60; ++ray, ++i) {
            const auto u = test::media_numbers(i, 5), v = test::media_numbers(i, 6);
            const Vec3 o = centre + placed.size * (0.1f + u[2]) * UniformSphere::sample(u[0], u[1]);
            // At the grid, along an axis, in any direction.
            Vec3 d = UniformSphere::sample(v[0], v[1]);
            if (ray % 3 == 0) d = normalized(centre + 0.1f * placed.size * d - o);
            if (ray % 10 == 1) d = {0.0f, -1.0f, 0.0f};
            const float end = ray % 7 == 0 ? HUGE_VALF : 4.0f * placed.size * u[3] + 1e-5f;
            SCOPED_TRACE(std::string(placed.name) + " " + std::to_string(i));
            test::expect_bounds_hold(density, {o, d}, end, i, 6);
            if (HasFatalFailure()) return;
          }
        }
      }
    }
  }
}

// Where bounds change and by how much, on one ray by hand: a voxel of 5 at 20 and nothing else.
TEST(GridMajorants, LeaveOutWhatIsEmpty) {
  const auto bytes = test::grid_bytes(
      [](int x, int y, int z) { return x == 20 && y == 20 && z == 20 ? 5.0f : 0.0f; }, {0, 0, 0},
      {100, 100, 100});
  const GridDensity density(field(bytes));
  const Ray ray{{-10.0f, 20.5f, 20.5f}, {1.0f, 0.0f, 0.0f}};
  const auto s = test::segments(density, ray, 200.0f);
  ASSERT_EQ(s.size(), 3u);
  EXPECT_EQ(s[0].majorant, 0.0f);
  EXPECT_FLOAT_EQ(s[0].end, 26.0f);
  EXPECT_EQ(s[1].majorant, 5.0f);
  EXPECT_FLOAT_EQ(s[1].end, 34.0f);
  EXPECT_EQ(s[2].majorant, 0.0f);
  EXPECT_EQ(test::segments(density, {{0, 50, 50}, {1, 0, 0}}, 100.0f).size(), 1u);
}

TEST(GridMajorants, AreCloseEnoughToPay) {
  const auto bytes = test::grid_bytes(
      [](int x, int y, int z) {
        const float r = std::sqrt(static_cast<float>(x * x + y * y + z * z));
        return std::max(0.0f, 1.0f - r / 60.0f);
      },
      {-60, -60, -60}, {60, 60, 60});
  const GridDensity density(field(bytes));
  // Slope 1/60 over at most 10 voxels and half of that on average, against a mean of 1/2.
  EXPECT_LT(test::waste(density, {{-100, 0.5f, 0.5f}, {1, 0, 0}}, 200.0f), 1.25);
}

// A grid that spans a large space has cells that fit into memory.
TEST(GridMajorants, CellsGrowWithEmptySpace) {
  const auto far = [](int x, int y, int z) { return x + y + z > 0 ? 1.0f : 2.0f; };
  auto bytes = test::grid_bytes(far, {0, 0, 0}, {7, 7, 7});
  EXPECT_EQ(GridDensity(field(bytes)).cell(), 8);
  // Another root node far away, of one value: 10^6 voxels from here.
  const auto spread = test::grid_bytes(
      [](int x, int y, int z) {
        return (x == 0 || x == 900'000) && y == 0 && z == 0 ? 3.0f : 0.0f;
      },
      {0, 0, 0}, {900'000, 0, 0});
  const GridDensity density(field(spread));
  EXPECT_EQ(density.field().at({900'000.0f, 0.0f, 0.0f}), 3.0f);
  EXPECT_GT(density.cell(), 8);
  double taken = 0.0, from = 0.0;
  for (const auto& s : test::segments(density, {{-10, 0, 0}, {1, 0, 0}}, 1e6f)) {
    if (s.majorant > 0.0f) taken += static_cast<double>(s.end) - from;
    from = static_cast<double>(s.end);
  }
  EXPECT_LT(taken, 4.0 * static_cast<double>(density.cell()));
}

}  // namespace
}  // namespace nocturne

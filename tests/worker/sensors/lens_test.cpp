// The thin lens and its opening: evenly filled, and blurring by as much as geometry says.
#include <gtest/gtest.h>

#include "sensors/sensors.h"
#include "support/chi_square.h"

namespace nocturne {
namespace {

using test::kPiExact;

// Inside the regular polygon by its edges' half planes; a disc where there are no blades.
bool inside(double x, double y, std::uint32_t blades, double angle) {
  if (blades == 0) return x * x + y * y < 1.0;
  for (std::uint32_t i = 0; i < blades; ++i) {
    const double middle = angle + 2.0 * kPiExact * (i + 0.5) / blades;
    if (x * std::cos(middle) + y * std::sin(middle) > std::cos(kPiExact / blades)) return false;
  }
  return true;
}

struct Opening {
  std::uint32_t blades;
  double angle;
};

class Openings : public testing::TestWithParam<Opening> {};

TEST_P(Openings, AreFilledEvenly) {
  constexpr std::uint32_t kCells = 24, kParts = 20, kDraws = 200'000;
  const auto [blades, angle] = GetParam();
  const Aperture aperture(2.0f, blades, static_cast<float>(angle));
  const double area = blades == 0 ? kPiExact : 0.5 * blades * std::sin(2.0 * kPiExact / blades);
  std::vector<double> observed(kCells * kCells), expected(kCells * kCells);
  const double part = 2.0 / (kCells * kParts);
  for (std::uint32_t row = 0; row < kCells * kParts; ++row) {
    for (std::uint32_t column = 0; column < kCells * kParts; ++column) {
      if (inside(part * (column + 0.5) - 1.0, part * (row + 0.5) - 1.0, blades, angle)) {
        expected[row / kParts * kCells + column / kParts] += kDraws * part * part / area;
      }
    }
  }
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const Uniform4 u = test::uniform(i, blades);
    const Aperture::Point point = aperture.sample(u[0], u[1]);
    EXPECT_TRUE(inside(0.5 / (1 + 1e-6) * point.x, 0.5 / (1 + 1e-6) * point.y, blades, angle));
    const auto cell = [](float x) {
      return std::min(static_cast<std::uint32_t>((0.5f * x + 1.0f) * 0.5f * kCells), kCells - 1);
    };
    observed[cell(point.y) * kCells + cell(point.x)] += 1.0;
  }
  test::expect_same_counts(observed, expected);
}

INSTANTIATE_TEST_SUITE_P(RoundAndPolygons, Openings,
                         testing::Values(Opening{0, 0.0}, Opening{3, 0.2}, Opening{5, 1.1},
                                         Opening{6, 0.0}, Opening{64, 3.0}));

TEST(Aperture, FirstCornerIsAtTheAngle) {
  const Aperture aperture(2.0f, 5, 0.3f);
  const Aperture::Point corner = aperture.sample(0x1.fffffep-1f / 5.0f, 0.0f);
  EXPECT_NEAR(corner.x, 2.0f * std::cos(0.3f), 1e-5f);
  EXPECT_NEAR(corner.y, 2.0f * std::sin(0.3f), 1e-5f);
}

TEST(ThinLens, RaysMeetInThePlaneOfFocus) {
  const Film film{64, 64};
  const Pose pose = test::oblique_pose();
  const Sensor pinhole = test::at_rest(Pinhole(0.5f), pose);
  const Sensor lens = test::at_rest(ThinLens(Pinhole(0.5f), Aperture(0.3f, 7, 0.1f), 4.0f), pose);
  const auto at_focus = [&](const Ray& ray) {
    return ray.origin + (4.0f / dot(ray.direction, pose.forward)) * ray.direction;
  };
  const Vec3 target = at_focus(pinhole.sample(film, 10, 50, 0, 0, 0).ray);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Uniform4 u = test::uniform(i, 3);
    const SensorSample sample = lens.sample(film, 10, 50, u[0], u[1], 0);
    EXPECT_LE(length(sample.ray.origin - pose.position), 0.3f + 1e-6f);
    EXPECT_NEAR(length(at_focus(sample.ray) - target), 0.0f, 1e-5f);
    // A pixel in focus is as wide as its ray says there.
    const float distance = length(target - sample.ray.origin);
    EXPECT_NEAR(sample.spread * distance, 4.0f / 64.0f, 1e-6f);
  }
  EXPECT_TRUE(lens.needs_lens());
}

// Published lens geometry: a lens of focal length f, opening A = f / N, focused at s, has its film
// at s' = f s / (s - f); a point at p blurs into a disc of c = A |p - s| / p x s' / s.
struct LensCase {
  const char* name;
  double focal, f_number, focus, point;  // mm
  double circle_of_confusion;            // mm
  double irradiance_over_radiance;       // sr
};

class Lenses : public testing::TestWithParam<LensCase> {
 protected:
  static constexpr Film kFilm{300, 200};
  static constexpr double kFilmHeight = 24.0;  // mm

  double radius() const { return 0.5 * GetParam().focal / GetParam().f_number; }
  double film_distance() const {
    return GetParam().focal * GetParam().focus / (GetParam().focus - GetParam().focal);
  }
  Sensor sensor() const {
    const auto tangent = static_cast<float>(0.5 * kFilmHeight / film_distance());
    // Metres; at the origin, so that rounding is that of the lens alone.
    Pose pose = test::pose();
    pose.position = {0, 0, 0};
    return test::at_rest(
        ThinLens(Pinhole(tangent), Aperture(static_cast<float>(1e-3 * radius()), 0, 0),
                 static_cast<float>(1e-3 * GetParam().focus)),
        pose);
  }
};

TEST_P(Lenses, BlurAPointIntoTheCircleOfConfusion) {
  // Where the ray of a film point and a lens point passes the plane of the object is linear in the
  // film point; so two rays say from which film point the ray through the object comes.
  const Sensor lens = sensor();
  const auto plane_x = [&](float x, float lens_u, float lens_v) {
    const Ray ray = lens.sample(kFilm, x, 100, lens_u, lens_v, 0).ray;
    const double along = 1e-3 * GetParam().point / -static_cast<double>(ray.direction.z);
    return static_cast<double>(ray.origin.x) + along * static_cast<double>(ray.direction.x);
  };
  double least = 1e9, most = -1e9;
  for (int i = 0; i <= 64; ++i) {
    for (const float lens_u : {0.0f, 0.25f, 1.0f}) {  // 0 and 1: on the rim
      const float lens_v = static_cast<float>(i) / 64.0f;
      const double at_left = plane_x(0, lens_u, lens_v), at_right = plane_x(300, lens_u, lens_v);
      const double x = -300.0 * at_left / (at_right - at_left);
      least = std::min(least, x);
      most = std::max(most, x);
    }
  }
  const double millimetres = kFilmHeight / kFilm.height * (most - least);
  // Single precision: positions of centimetres on a plane of metres.
  EXPECT_NEAR(millimetres, GetParam().circle_of_confusion, 2e-5 * GetParam().circle_of_confusion);
}

TEST_P(Lenses, FillTheirOpeningAsTheFilmSeesIt) {
  // Irradiance on the axis: radiance x the integral of cos^4 / s'^2 over the opening, which in
  // closed form is pi sin^2 of the angle of the opening's rim.
  const Sensor lens = sensor();
  constexpr int kGrid = 512;
  double sum = 0.0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const auto u = (static_cast<float>(i % kGrid) + 0.5f) / kGrid;
    const auto v = (static_cast<float>(i / kGrid) + 0.5f) / kGrid;
    const Vec3 point = lens.sample(kFilm, 150, 100, u, v, 0).ray.origin;
    const double r = 1e3 * std::hypot(point.x, point.y), d = film_distance();
    sum += d * d / std::pow(r * r + d * d, 2);
  }
  const double area = kPiExact * radius() * radius();
  EXPECT_NEAR(area * sum / (kGrid * kGrid), GetParam().irradiance_over_radiance,
              1e-5 * GetParam().irradiance_over_radiance);
}

INSTANTIATE_TEST_SUITE_P(
    FiftyAndEightyFive, Lenses,
    testing::Values(LensCase{"f50", 50, 2.0, 2000, 4000, 0.32051282, 0.17618681},
                    LensCase{"f85", 85, 1.4, 3000, 2000, 0.88519971, 0.33766452}),
    [](const auto& lens) { return lens.param.name; });

}  // namespace
}  // namespace nocturne

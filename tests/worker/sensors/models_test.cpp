// Directions, sizes and weights of each model against closed forms.
#include <gtest/gtest.h>

#include <functional>

#include "sensors/sensors.h"
#include "support/chi_square.h"

namespace nocturne {
namespace {

using test::at_rest;
using test::Estimate;
using test::kPiExact;

constexpr float kLooseAngle = 1e-6f;

void expect_direction(const SensorSample& sample, Vec3 expected) {
  EXPECT_NEAR(length(sample.ray.direction - expected), 0.0f, kLooseAngle);
  EXPECT_NEAR(length(sample.ray.direction), 1.0f, kLooseAngle);
}

// The mean of weight x radiance over a pixel, radiance a function of the direction that it comes
// from, and its error.
using Radiance = std::function<double(const Ray&)>;
struct Measured {
  double value, error;
};
Measured measure(const Sensor& sensor, Film film, std::uint32_t column, std::uint32_t row,
                 const Radiance& radiance) {
  constexpr std::uint32_t kSamples = 40'000;
  Estimate estimate;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const Uniform4 u = test::uniform(i, row * film.width + column);
    const auto sample = sensor.sample(film, static_cast<float>(column) + u[0],
                                      static_cast<float>(row) + u[1], u[2], u[3], 0);
    estimate.add(sample.weight * radiance(sample.ray));
  }
  return {estimate.mean(kSamples), std::sqrt(estimate.variance(kSamples))};
}

// Four standard errors: a false alarm in 16,000.
void expect_measured(const Measured& measured, double expected) {
  EXPECT_NEAR(measured.value, expected, 4.0 * measured.error + 1e-6 * std::fabs(expected));
}

TEST(Pinhole, CornersOfTheFilmSpanTheFieldOfView) {
  const Sensor sensor = at_rest(Pinhole(0.5f));
  const Film film{200, 100};
  const SensorSample top_left = sensor.sample(film, 0, 0, 0, 0, 0);
  EXPECT_FLOAT_EQ(top_left.ray.direction.x / -top_left.ray.direction.z, -1.0f);  // 2 x tan 0.5
  EXPECT_FLOAT_EQ(top_left.ray.direction.y / -top_left.ray.direction.z, 0.5f);
  const SensorSample middle = sensor.sample(film, 100, 50, 0, 0, 0);
  expect_direction(middle, {0, 0, -1});
  EXPECT_FLOAT_EQ(middle.spread, 0.01f);  // 100 pixels over 1 at distance 1
  EXPECT_EQ(middle.width, 0.0f);
  EXPECT_EQ(middle.weight, 1.0f);
  EXPECT_FALSE(sensor.needs_lens());
  EXPECT_FALSE(sensor.moves());
}

TEST(Orthographic, RaysAreParallelAndAPixelApart) {
  const Sensor sensor = at_rest(Orthographic(FilmRectangle(2.0f)));
  const Film film{200, 100};
  const SensorSample corner = sensor.sample(film, 0, 0, 0, 0, 0);
  EXPECT_NEAR(length(corner.ray.origin - Vec3{-1, 3, 3}), 0.0f, 1e-6f);
  expect_direction(corner, {0, 0, -1});
  const SensorSample next = sensor.sample(film, 1, 0, 0, 0, 0);
  EXPECT_NEAR(length(next.ray.origin - corner.ray.origin), corner.width, 1e-6f);
  EXPECT_EQ(corner.spread, 0.0f);
  EXPECT_EQ(corner.weight, 1.0f);
  EXPECT_FALSE(sensor.needs_lens());
}

TEST(DirectionGrid, SolidAnglesAddUpToAllDirections) {
  for (const Film film : {Film{1, 1}, Film{7, 5}, Film{64, 32}, Film{2048, 16384}}) {
    double sum = 0.0;
    for (std::uint32_t row = 0; row < film.height; ++row) {
      sum += film.width * DirectionGrid{film}.solid_angle(row);
    }
    EXPECT_NEAR(sum, 4.0 * kPiExact, 1e-11);
  }
}

TEST(DirectionGrid, PointsStayInTheirCellUpToThePoles) {
  const DirectionGrid grid{{16384, 8192}};
  for (const std::uint32_t row : {0u, 1u, 4095u, 8190u, 8191u}) {
    const auto point = grid.at(77.5f, static_cast<float>(row) + 0.5f);
    EXPECT_EQ(grid.row(std::atan2(point.sine, point.cosine)), row);
    EXPECT_EQ(grid.column(point.azimuth), 77u);
    EXPECT_EQ(grid.column(point.azimuth - 2.0 * kPiExact), 77u);
  }
}

TEST(DirectionGrid, UniformPointsAreUniformDirections) {
  const DirectionGrid grid{{1, 1}};
  test::expect_samples_match_pdf(
      [&](const Uniform4& u) -> std::optional<Vec3> {
        const auto point = grid.at(u[0], u[1]);
        return Vec3{static_cast<float>(point.sine * std::cos(point.azimuth)),
                    static_cast<float>(point.sine * std::sin(point.azimuth)),
                    static_cast<float>(point.cosine)};
      },
      [](Vec3) { return UniformSphere::pdf(); }, 4);
}

TEST(Panorama, ForwardIsInTheMiddleAndRightToTheRight) {
  const Sensor sensor = at_rest(Panorama{});
  const Film film{64, 32};
  // Between rows 15 and 16 is the horizon.
  expect_direction(sensor.sample(film, 32, 16, 0, 0, 0), {0, 0, -1});
  expect_direction(sensor.sample(film, 48, 16, 0, 0, 0), {1, 0, 0});
  expect_direction(sensor.sample(film, 16, 16, 0, 0, 0), {-1, 0, 0});
  expect_direction(sensor.sample(film, 0, 16, 0, 0, 0), {0, 0, 1});
  expect_direction(sensor.sample(film, 64, 16, 0, 0, 0), {0, 0, 1});
  expect_direction(sensor.sample(film, 5, 0, 0, 0, 0), {0, 1, 0});
  expect_direction(sensor.sample(film, 5, 32, 0, 0, 0), {0, -1, 0});
  // Row edges are equal steps of the angle.
  const float angle = std::numbers::pi_v<float> / 8;
  expect_direction(sensor.sample(film, 32, 4, 0, 0, 0), {0, std::cos(angle), -std::sin(angle)});
  EXPECT_FALSE(sensor.needs_lens());
}

TEST(Panorama, PixelsTimesSolidAnglesIntegrateRadiance) {
  // (1 + z)^2 over the sphere: 2 pi x 8/3.
  const Sensor sensor = at_rest(Panorama{}, test::oblique_pose());
  const Film film{6, 4};
  double sum = 0.0, variance = 0.0;
  for (std::uint32_t row = 0; row < film.height; ++row) {
    for (std::uint32_t column = 0; column < film.width; ++column) {
      const auto pixel = measure(sensor, film, column, row,
                                 [](const Ray& ray) { return std::pow(1.0 + ray.direction.z, 2); });
      const double solid_angle = DirectionGrid{film}.solid_angle(row);
      sum += solid_angle * pixel.value;
      variance += std::pow(solid_angle * pixel.error, 2);
    }
  }
  expect_measured({sum, std::sqrt(variance)}, 16.0 / 3.0 * kPiExact);
}

TEST(Plane, UniformHemisphereGivesPiTimesRadiance) {
  const Sensor sensor = at_rest(Plane(FilmRectangle(1.0f)), test::oblique_pose());
  const auto measured = measure(sensor, {2, 2}, 1, 0, [](const Ray&) { return 2.0; });
  EXPECT_NEAR(measured.value, 2.0 * kPiExact, 1e-5);
  EXPECT_TRUE(sensor.needs_lens());
}

TEST(Plane, SkyWithAGradientGivesItsIntegral) {
  // Radiance (1 + 2 sin h) / 3, sin h the cosine to forward (Moon and Spencer's overcast sky):
  // pi (1/3 + 4/9) = 7 pi / 9.
  const Pose where = test::oblique_pose();
  const Sensor sensor = at_rest(Plane(FilmRectangle(1.0f)), where);
  const auto measured = measure(sensor, {2, 2}, 0, 1, [&](const Ray& ray) {
    const double sine = dot(ray.direction, where.forward);
    return sine < 0.0 ? 1e9 : (1.0 + 2.0 * sine) / 3.0;
  });
  expect_measured(measured, 7.0 / 9.0 * kPiExact);
}

TEST(Plane, StartsInItsPixelInFrontOfTheFilm) {
  const Sensor sensor = at_rest(Plane(FilmRectangle(2.0f)));
  const Film film{200, 100};
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Uniform4 u = test::uniform(i, 1);
    const auto sample = sensor.sample(film, 20.0f + u[0], 30.0f + u[1], u[2], u[3], 0);
    const Vec3 from_corner = sample.ray.origin - Vec3{-1, 3, 3};
    EXPECT_GE(from_corner.x, 0.4f - 1e-6f);
    EXPECT_LE(from_corner.x, 0.42f + 1e-6f);
    EXPECT_LE(from_corner.y, -0.6f + 1e-6f);
    EXPECT_GE(from_corner.y, -0.62f - 1e-6f);
    EXPECT_LT(from_corner.z, 0.0f);
    EXPECT_GT(from_corner.z, -1e-4f);
    EXPECT_GE(dot(sample.ray.direction, {0, 0, -1}), 0.0f);
    EXPECT_FLOAT_EQ(sample.width, 0.02f);
  }
}

TEST(RadianceMeter, UniformRadianceIsItself) {
  const Sensor sensor = at_rest(RadianceMeter(0.01f, 0.1f));
  const auto measured = measure(sensor, {3, 3}, 1, 2, [](const Ray&) { return 5.0; });
  EXPECT_NEAR(measured.value, 5.0, 1e-5);
  EXPECT_TRUE(sensor.needs_lens());
}

TEST(RadianceMeter, IsFluxOverEtendue) {
  // Radiance cos^2 inside a cone of half angle a: flux over etendue is (1 - cos^4 a) / (2 sin^2 a),
  // which for the whole hemisphere is 1/2.
  for (const float angle : {0.6f, 0.5f * std::numbers::pi_v<float>}) {
    const Sensor sensor = at_rest(RadianceMeter(0.2f, angle), test::oblique_pose());
    const Vec3 forward = test::oblique_pose().forward;
    const auto measured = measure(sensor, {3, 3}, 0, 1, [&](const Ray& ray) {
      const double cosine = dot(ray.direction, forward);
      EXPECT_GE(cosine, std::cos(angle) - 1e-6);
      return cosine * cosine;
    });
    const double c = std::cos(static_cast<double>(angle));
    expect_measured(measured, (1.0 - c * c * c * c) / (2.0 * (1.0 - c * c)));
  }
}

TEST(RadianceMeter, DiscIsFilledEvenly) {
  // Mean of r^2 over a disc of radius 0.1: 0.005.
  const Sensor sensor = at_rest(RadianceMeter(0.2f, 0.3f));
  const auto measured = measure(sensor, {3, 3}, 2, 2, [](const Ray& ray) {
    const Vec3 from_centre = ray.origin - test::pose().position;
    EXPECT_NEAR(from_centre.z, 0.0f, 1e-6f);
    return static_cast<double>(dot(from_centre, from_centre));
  });
  expect_measured(measured, 0.005);
}

TEST(IntensityMeter, ColumnsGoFromRightTowardsUpAndRowsFromForward) {
  const Sensor sensor = at_rest(IntensityMeter(0.5f));
  const Film film{8, 4};
  // Rays look back at the lamp.
  expect_direction(sensor.sample(film, 0, 0, 0.5f, 0.5f, 0), {0, 0, 1});
  expect_direction(sensor.sample(film, 0, 2, 0.5f, 0.5f, 0), {-1, 0, 0});
  expect_direction(sensor.sample(film, 2, 2, 0.5f, 0.5f, 0), {0, -1, 0});
  expect_direction(sensor.sample(film, 3, 4, 0.5f, 0.5f, 0), {0, 0, -1});
}

TEST(IntensityMeter, RaysFillTheShadowOfTheSphere) {
  const Sensor sensor = at_rest(IntensityMeter(0.5f), test::oblique_pose());
  // Mean squared distance of the rays from the centre, 0.5^2 / 2, times pi 0.5^2.
  const auto measured = measure(sensor, {8, 4}, 3, 1, [](const Ray& ray) {
    const Vec3 from_centre = ray.origin - test::oblique_pose().position;
    const float along = dot(from_centre, ray.direction);
    EXPECT_LT(along, -0.5f);
    const Vec3 across = from_centre - along * ray.direction;
    EXPECT_LE(length(across), 0.5f + 1e-6f);
    return static_cast<double>(dot(across, across));
  });
  expect_measured(measured, 0.125 * kPiExact * 0.25);
}

TEST(IntensityMeter, SphereHasTheSameIntensityAllAround) {
  // Radiance 3 from a sphere of radius 0.2: pi 0.2^2 x 3 in every direction.
  const Vec3 centre = test::oblique_pose().position + Vec3{0.1f, -0.2f, 0.1f};
  const Sensor sensor = at_rest(IntensityMeter(0.5f), test::oblique_pose());
  const Film film{4, 3};
  for (std::uint32_t row = 0; row < film.height; ++row) {
    const auto measured = measure(sensor, film, row, row, [&](const Ray& ray) {
      const Vec3 c = centre - ray.origin;
      return length(c - dot(c, ray.direction) * ray.direction) < 0.2f ? 3.0 : 0.0;
    });
    expect_measured(measured, 3.0 * kPiExact * 0.04);
  }
}

TEST(Models, RefuseWhatMeansNothing) {
  EXPECT_THROW(Pinhole(0.0f), std::invalid_argument);
  EXPECT_THROW(ThinLens(Pinhole(1.0f), Aperture(0.1f, 0, 0.0f), 0.0f), std::invalid_argument);
  EXPECT_THROW(Aperture(0.0f, 0, 0.0f), std::invalid_argument);
  EXPECT_THROW(Aperture(0.1f, 2, 0.0f), std::invalid_argument);
  EXPECT_THROW(Aperture(0.1f, 65, 0.0f), std::invalid_argument);
  EXPECT_THROW(FilmRectangle(-1.0f), std::invalid_argument);
  EXPECT_THROW(RadianceMeter(0.0f, 0.1f), std::invalid_argument);
  EXPECT_THROW(RadianceMeter(0.1f, 1.6f), std::invalid_argument);
  EXPECT_THROW(IntensityMeter(0.0f), std::invalid_argument);
}

}  // namespace
}  // namespace nocturne

// Forward photons are counted where adjoint photons start: a lamp on paper measured in both
// directions.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "sensors/sensors.h"
#include "support/chi_square.h"
#include "surfaces/hit.h"

namespace nocturne {
namespace {

using test::Estimate;
using test::kPiExact;

constexpr std::uint32_t kPhotons = 400'000;
constexpr std::uint32_t kSamplesPerPixel = 10'000;

using Receive = std::function<std::optional<SplatWeight>(const Ray&)>;

std::vector<Estimate> forward(const test::Patch& lamp, Film film, const Receive& receive) {
  std::vector<Estimate> pixels(static_cast<std::size_t>(film.width) * film.height);
  const double flux = kPiExact * lamp.area();
  for (std::uint32_t i = 0; i < kPhotons; ++i) {
    const auto splat = receive(lamp.emit(test::uniform(i, 1)));
    if (splat) pixels.at(splat->pixel).add(flux * splat->weight);
  }
  return pixels;
}

std::vector<Estimate> adjoint(const test::Patch& lamp, Film film, const Sensor& sensor) {
  std::vector<Estimate> pixels;
  for (std::uint32_t pixel = 0; pixel < film.width * film.height; ++pixel) {
    auto& estimate = pixels.emplace_back();
    for (std::uint32_t i = 0; i < kSamplesPerPixel; ++i) {
      const Uniform4 u = test::uniform(i, 2 + pixel);
      const auto sample =
          sensor.sample(film, static_cast<float>(pixel % film.width) + u[0],
                        static_cast<float>(pixel / film.width) + u[1], u[2], u[3], 0);
      estimate.add(lamp.lights(sample.ray) ? sample.weight : 0.0);
    }
  }
  return pixels;
}

// Sum over pixels of squared differences over their variances: a chi-square statistic. One false
// alarm in 30,000.
void expect_same(const std::vector<Estimate>& one, const std::vector<Estimate>& other) {
  double statistic = 0.0;
  int lit = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const double variance = one[i].variance(kPhotons) + other[i].variance(kSamplesPerPixel);
    const double difference = one[i].mean(kPhotons) - other[i].mean(kSamplesPerPixel);
    if (variance == 0.0) {
      EXPECT_EQ(difference, 0.0);
      continue;
    }
    statistic += difference * difference / variance;
    ++lit;
  }
  ASSERT_GT(lit, 10);
  EXPECT_LT(test::chi_square_deviate(statistic, lit), 4.0) << statistic << " over " << lit;
}

TEST(Splat, PlaneMeasuresTheSameBothWays) {
  const Film film{6, 4};
  const Pose pose = test::oblique_pose();
  const Sensor sensor = test::at_rest(Plane(FilmRectangle(1.0f)), pose);
  // Tilted, in front of the film; a part of its light goes behind it.
  const Vec3 corner = pose.position + 0.7f * pose.forward + 0.2f * pose.right;
  const test::Patch lamp{corner, 0.5f * pose.up + 0.1f * pose.forward,
                         0.4f * pose.right - 0.3f * pose.forward};
  ASSERT_NE(dot(lamp.normal(), pose.forward), 0.0f);
  const test::Patch towards_film = dot(lamp.normal(), pose.forward) < 0.0f
                                       ? lamp
                                       : test::Patch{lamp.corner, lamp.edge_v, lamp.edge_u};
  const auto counted = forward(towards_film, film, [&](const Ray& ray) {
    return sensor.splat_segment(film, ray.origin, ray.direction,
                                std::numeric_limits<float>::infinity(), 0);
  });
  expect_same(counted, adjoint(towards_film, film, sensor));
}

TEST(Splat, IntensityMeasuresTheSameBothWaysAndIsTheCosineLaw) {
  const Film film{8, 6};
  const Pose pose = test::oblique_pose();
  const Sensor sensor = test::at_rest(IntensityMeter(0.5f), pose);
  const test::Patch lamp{pose.position, {0.3f, 0.1f, 0}, {0, 0.2f, 0.3f}};
  const auto counted =
      forward(lamp, film, [&](const Ray& ray) { return sensor.splat_escape(film, ray.direction); });
  expect_same(counted, adjoint(lamp, film, sensor));
  // All flux is counted: the sum of intensity x solid angle is pi x area.
  double flux = 0.0;
  for (std::uint32_t i = 0; i < counted.size(); ++i) {
    flux += counted[i].mean(kPhotons) * DirectionGrid{film}.solid_angle(i / film.width);
  }
  EXPECT_NEAR(flux, kPiExact * lamp.area(), 1e-6);
  // Straight ahead of the lamp: area x cos, averaged over a cell; against the middle of a fine one.
  const Film fine{4096, 2048};
  const auto cell = sensor.splat_escape(fine, lamp.normal());
  ASSERT_TRUE(cell);
  Estimate ahead;
  for (std::uint32_t i = 0; i < kPhotons; ++i) {
    const Uniform4 u = test::uniform(i, 100);
    const auto sample =
        sensor.sample(fine, static_cast<float>(cell->pixel % fine.width) + u[0],
                      static_cast<float>(cell->pixel / fine.width) + u[1], u[2], u[3], 0);
    ahead.add(lamp.lights(sample.ray) ? sample.weight : 0.0);
  }
  EXPECT_NEAR(ahead.mean(kPhotons), lamp.area(), 4.0 * std::sqrt(ahead.variance(kPhotons)));
}

TEST(Splat, EscapesMeetThePixelThatLooksBack) {
  const Film film{36, 18};
  const Sensor sensor = test::at_rest(IntensityMeter(0.5f), test::oblique_pose());
  for (std::uint32_t pixel = 0; pixel < film.width * film.height; ++pixel) {
    const auto sample = sensor.sample(film, static_cast<float>(pixel % film.width) + 0.5f,
                                      static_cast<float>(pixel / film.width) + 0.5f, 0.1f, 0.9f, 0);
    const auto splat = sensor.splat_escape(film, -sample.ray.direction);
    ASSERT_TRUE(splat);
    EXPECT_EQ(splat->pixel, pixel);
    EXPECT_NEAR(splat->weight * DirectionGrid{film}.solid_angle(pixel / film.width), 1.0, 1e-6);
  }
}

// A photon is sent to the camera from each point of a lamp of radiance 1, in front of the camera.
class Cameras : public testing::TestWithParam<std::function<SensorModel()>> {
 protected:
  static constexpr Film kFilm{24, 16};
  const Pose pose_ = test::oblique_pose();
  const Sensor sensor_ = test::at_rest(GetParam()(), pose_);

  test::Patch lamp() const {
    return {pose_.position + 0.7f * pose_.forward - 0.3f * pose_.right - 0.2f * pose_.up,
            0.5f * pose_.right + 0.1f * pose_.forward, 0.4f * pose_.up + 0.2f * pose_.right};
  }
};

TEST_P(Cameras, MeasureTheSameBothWays) {
  const test::Patch towards = dot(lamp().normal(), pose_.forward) < 0.0f
                                  ? lamp()
                                  : test::Patch{lamp().corner, lamp().edge_v, lamp().edge_u};
  std::vector<Estimate> counted(kFilm.width * kFilm.height);
  for (std::uint32_t i = 0; i < kPhotons; ++i) {
    const Uniform4 u = test::uniform(i, 1);
    const Vec3 place = towards.corner + u[0] * towards.edge_u + u[1] * towards.edge_v;
    const auto way = sensor_.connect(kFilm, place, u[2], u[3], 0);
    if (!way) continue;
    const double cosine = dot(towards.normal(), way->direction);
    counted.at(way->pixel).add(towards.area() * std::max(0.0, cosine) * way->weight);
  }
  expect_same(counted, adjoint(towards, kFilm, sensor_));
}

TEST_P(Cameras, AreReachedBackAlongTheirRays) {
  const Film film{40, 30};
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Uniform4 u = test::uniform(i, 2), v = test::uniform(i, 3);
    const auto sample = sensor_.sample(film, 40.0f * u[0], 30.0f * u[1], v[0], v[1], 0);
    const float distance = 0.5f + 3.0f * u[2];
    const auto way =
        sensor_.connect(film, sample.ray.origin + distance * sample.ray.direction, v[0], v[1], 0);
    ASSERT_TRUE(way);
    EXPECT_NEAR(dot(way->direction, sample.ray.direction), -1.0f, 1e-5f);
    EXPECT_NEAR(way->distance, distance, 1e-5f * distance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, Cameras,
    testing::Values([] { return SensorModel(Pinhole(0.4f)); },
                    [] {
                      return SensorModel(ThinLens(Pinhole(0.4f), Aperture(0.1f, 5, 0.2f), 0.5f));
                    },
                    [] { return SensorModel(Orthographic(FilmRectangle(0.5f))); },
                    [] { return SensorModel(Panorama()); }));

class Film2x2 : public testing::Test {
 protected:
  static constexpr Film kFilm{2, 2};
  const Sensor sensor_ = test::at_rest(Plane(FilmRectangle(2.0f)));  // looks along -z from z = 3

  std::optional<SplatWeight> receive(Vec3 origin, Vec3 direction, float distance) const {
    return sensor_.splat_segment(kFilm, origin, direction, distance, 0);
  }
};

TEST_F(Film2x2, CountsWhatArrivesFromTheFront) {
  const auto top_left = receive({0.5f, 2.5f, 2}, {0, 0, 1}, 5);
  ASSERT_TRUE(top_left);
  EXPECT_EQ(top_left->pixel, 0u);
  EXPECT_FLOAT_EQ(top_left->weight, 1.0f);
  EXPECT_EQ(receive({1.5f, 2.5f, 2}, {0, 0, 1}, 5)->pixel, 1u);
  EXPECT_EQ(receive({0.5f, 1.5f, 2}, {0, 0, 1}, 5)->pixel, 2u);
  EXPECT_FALSE(receive({0.5f, 1.5f, 4}, {0, 0, -1}, 5)) << "from behind";
  EXPECT_FALSE(receive({0.5f, 1.5f, 2}, {0, 0, 1}, 0.9f)) << "ends before";
  EXPECT_FALSE(receive({0.5f, 1.5f, 4}, {0, 0, 1}, 9)) << "starts beyond";
  EXPECT_FALSE(receive({-0.1f, 1.5f, 2}, {0, 0, 1}, 5)) << "beside";
  EXPECT_FALSE(receive({0.5f, 3.1f, 2}, {0, 0, 1}, 5)) << "above";
  EXPECT_FALSE(receive({0.5f, 1.5f, 2}, {1, 0, 0}, 5)) << "along";
}

TEST_F(Film2x2, CountsOnceWhereASurfaceIsInItsPlane) {
  // A photon that ends on the surface, within rounding, and goes on from either side of it.
  for (const float rounding : {-1e-6f, 0.0f, 1e-6f}) {
    EXPECT_TRUE(receive({0.5f, 1.5f, 2}, {0, 0, 1}, 1.0f + rounding));
    const Vec3 end{0.5f, 1.5f, 3.0f + rounding};
    // As for a triangle of 2 m around there.
    const float clearance = kClearanceUnits * (3.0f + 2.0f);
    for (const Vec3 onwards : {Vec3{0, 0, 1}, Vec3{0.6f, 0, -0.8f}, Vec3{0.8f, 0, 0.6f}}) {
      EXPECT_FALSE(
          receive(end + (onwards.z > 0 ? clearance : -clearance) * Vec3{0, 0, 1}, onwards, 9));
    }
  }
}

TEST(Splat, OtherModelsCountNothing) {
  const Sensor sensor = test::at_rest(Pinhole(1.0f));
  EXPECT_FALSE(sensor.splats_segments());
  EXPECT_FALSE(sensor.receives_escapes());
  EXPECT_FALSE(sensor.splat_segment({2, 2}, {1, 2, 0}, {0, 0, 1}, 9, 0));
  EXPECT_FALSE(sensor.splat_escape({2, 2}, {0, 0, 1}));
  EXPECT_TRUE(sensor.is_camera());
  const Sensor meter = test::at_rest(RadianceMeter(0.1f, 0.1f));
  EXPECT_FALSE(meter.is_camera());
  EXPECT_FALSE(meter.connect({2, 2}, {1, 2, 0}, 0, 0, 0));
}

TEST(Splat, FilmThatMovesIsMetWhereItIs) {
  Pose end = test::pose();
  end.position.z = 5;
  const Sensor sensor(Plane(FilmRectangle(2.0f)), Motion({test::pose(), end}));
  EXPECT_FALSE(sensor.splat_segment({2, 2}, {1, 2, 2}, {0, 0, 1}, 1.5f, 0.5f));
  EXPECT_TRUE(sensor.splat_segment({2, 2}, {1, 2, 2}, {0, 0, 1}, 1.5f, 0.2f));
}

}  // namespace
}  // namespace nocturne

#include "sensors/camera.h"

#include <gtest/gtest.h>

namespace nocturne {
namespace {

Camera camera(float lens_radius) {
  return {{1, 2, 3}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 0.5f, lens_radius, 4.0f};
}

TEST(Camera, CornersOfTheFilmSpanTheFieldOfView) {
  const Film film{200, 100};
  const Ray top_left = camera(0).ray(film, 0, 0, 0, 0);
  EXPECT_FLOAT_EQ(top_left.direction.x / -top_left.direction.z, -1.0f);  // aspect 2 x tan 0.5
  EXPECT_FLOAT_EQ(top_left.direction.y / -top_left.direction.z, 0.5f);
  const Ray middle = camera(0).ray(film, 100, 50, 0, 0);
  EXPECT_FLOAT_EQ(middle.direction.z, -1.0f);
}

TEST(Camera, LensRaysMeetInThePlaneOfFocus) {
  const Film film{64, 64};
  const Ray sharp = camera(0).ray(film, 10, 50, 0, 0);
  const Vec3 target = sharp.origin + (4.0f / -sharp.direction.z) * sharp.direction;
  for (const float u : {0.1f, 0.5f, 0.9f}) {
    const Ray ray = camera(0.3f).ray(film, 10, 50, u, 1.0f - u * u);
    EXPECT_LE(length(ray.origin - Vec3{1, 2, 3}), 0.3f);
    const Vec3 met = ray.origin + (4.0f / -ray.direction.z) * ray.direction;
    EXPECT_NEAR(length(met - target), 0.0f, 1e-5f);
  }
}

}  // namespace
}  // namespace nocturne

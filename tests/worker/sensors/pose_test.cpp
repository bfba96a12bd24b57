// Sensors that move over the shutter.
#include <gtest/gtest.h>

#include "sensors/sensors.h"

namespace nocturne {
namespace {

Pose turned(float angle) {
  Pose pose = test::pose();
  pose.right = {std::cos(angle), 0, std::sin(angle)};
  pose.forward = {std::sin(angle), 0, -std::cos(angle)};
  return pose;
}

void expect_orthonormal(const Pose& pose) {
  EXPECT_NEAR(length(pose.right), 1.0f, 1e-6f);
  EXPECT_NEAR(length(pose.forward), 1.0f, 1e-6f);
  EXPECT_NEAR(length(cross(pose.right, pose.up) + pose.forward), 0.0f, 1e-6f);
}

TEST(Motion, TranslationIsExactlyLinear) {
  Pose end = test::oblique_pose();
  const Vec3 start = end.position;
  end.position = start + Vec3{2, -1, 4};
  const Motion motion({test::oblique_pose(), end});
  for (const float t : {0.0f, 0.25f, 0.5f, 1.0f}) {
    const Pose pose = motion.at(t);
    EXPECT_NEAR(length(pose.position - (start + t * Vec3{2, -1, 4})), 0.0f, 1e-6f);
    EXPECT_EQ(pose.right.x, end.right.x);  // to the last bit
    EXPECT_EQ(pose.up.y, end.up.y);
    EXPECT_EQ(pose.forward.z, end.forward.z);
  }
  EXPECT_TRUE(motion.moves());
}

TEST(Motion, PosesAreMetAtTheirTimes) {
  Pose middle = turned(0.4f), end = turned(-0.2f);
  middle.position = {5, 0, 0};
  const Motion motion({test::pose(), middle, end});
  EXPECT_NEAR(length(motion.at(0.5f).position - middle.position), 0.0f, 1e-6f);
  EXPECT_NEAR(length(motion.at(0.5f).forward - middle.forward), 0.0f, 1e-6f);
  EXPECT_NEAR(length(motion.at(1.0f).forward - end.forward), 0.0f, 1e-6f);
  EXPECT_NEAR(motion.at(0.25f).position.x, 3.0f, 1e-6f);
  EXPECT_NEAR(motion.at(0.75f).position.x, 3.0f, 1e-6f);
}

TEST(Motion, TurningFramesStayOrthonormal) {
  const Motion motion({turned(0), turned(1.5f), test::oblique_pose()});
  for (int i = 0; i <= 100; ++i) expect_orthonormal(motion.at(0.01f * static_cast<float>(i)));
  // In the middle between two frames, by symmetry, the angle is half.
  EXPECT_NEAR(length(motion.at(0.25f).forward - turned(0.75f).forward), 0.0f, 1e-6f);
}

TEST(Motion, RefusesWhatHasNoDirection) {
  EXPECT_THROW(Motion({}), std::invalid_argument);
  EXPECT_THROW(Motion({turned(0), turned(kPi)}), std::invalid_argument);
  EXPECT_NO_THROW(Motion({turned(0), turned(3.0f)}));
  Pose skewed = test::pose();
  skewed.right = {1, 0.1f, 0};
  EXPECT_THROW(Motion({skewed}), std::invalid_argument);
  Pose mirrored = test::pose();
  mirrored.up = {0, -1, 0};
  EXPECT_THROW(Motion({mirrored}), std::invalid_argument);
}

TEST(Sensor, SamplesFromWhereItIsAtTheTime) {
  Pose end = turned(0.5f);
  end.position = {3, 2, 3};
  const Sensor sensor(Pinhole(0.5f), Motion({test::pose(), end}));
  EXPECT_TRUE(sensor.moves());
  const Film film{10, 10};
  const Ray ray = sensor.sample(film, 5, 5, 0, 0, 0.5f).ray;
  EXPECT_NEAR(length(ray.origin - Vec3{2, 2, 3}), 0.0f, 1e-6f);
  EXPECT_NEAR(length(ray.direction - turned(0.25f).forward), 0.0f, 1e-6f);
}

TEST(Sensor, PixelOfAMovingSensorSeesABarAsATrapezoid) {
  // A bar of width 1 on black and an orthographic sensor that passes it by 3 within the shutter:
  // its pixels see 1/3 on the plateau, 1/6 at the middle of a ramp, as the convolution of two boxes
  // says.
  Pose end = test::pose();
  end.position.x -= 3.0f;
  const Film film{2000, 1};
  const Sensor sensor(Orthographic(FilmRectangle(0.005f)), Motion({test::pose(), end}));
  const auto seen = [&](float x) {
    constexpr int kTimes = 3000;
    int hits = 0;
    for (int i = 0; i < kTimes; ++i) {
      const float time = (static_cast<float>(i) + 0.5f) / kTimes;
      const float at = sensor.sample(film, x, 0.5f, 0, 0, time).ray.origin.x;
      hits += at >= 0.0f && at < 1.0f;
    }
    return static_cast<double>(hits) / kTimes;
  };
  // The pixel at x is at 1 + (x - 1000) / 200 at the start.
  EXPECT_NEAR(seen(1000 + 200 * 1.0f), 1.0 / 3.0, 2e-3);
  EXPECT_NEAR(seen(1000 + 200 * -0.5f), 1.0 / 6.0, 2e-3);
  EXPECT_NEAR(seen(1000 + 200 * 2.5f), 1.0 / 6.0, 2e-3);
  EXPECT_EQ(seen(1000 + 200 * -1.5f), 0.0);
}

}  // namespace
}  // namespace nocturne

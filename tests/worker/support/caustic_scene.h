#pragma once

#include "support/scene_builder.h"

namespace nocturne::test {

inline SceneBuilder two_photons() {
  SceneBuilder builder;
  builder.message.mutable_tracing()->set_estimator(v1::ESTIMATOR_TWO_PHOTONS);
  return builder;
}

inline void add_glass_ball(SceneBuilder& builder, Vec3 centre, double radius) {
  builder.add_glass_box({9, 9, 9}, {9.1f, 9.1f, 9.1f}, 1.5f);
  auto& surfaces = *builder.message.mutable_surfaces();
  auto& sphere = *surfaces.Mutable(surfaces.size() - 1)->mutable_sphere();
  SceneBuilder::set(*sphere.mutable_centre(), centre);
  sphere.set_radius(radius);
  surfaces.DeleteSubrange(surfaces.size() - 6, 5);
}

/// A small lamp above a floor, and a ball of glass between them if there is one.
inline SceneBuilder floor_and_lamp(bool ball) {
  SceneBuilder builder = two_photons();
  builder.add_quad(0.5f, 0.0f, {-2, -1, -2}, {0, 0, 4}, {4, 0, 0});
  builder.add_sphere(0.0f, 5e4f, {0, 3, -0.5f}, 0.02);
  builder.look({0, 1, 3}, {0, -1, -0.5f}, 0.5);
  if (ball) {
    add_glass_ball(builder, {0, -0.3f, -0.5f}, 0.5);
    builder.message.mutable_tracing()->set_direction(v1::DIRECTION_BOTH);
  }
  return builder;
}

}  // namespace nocturne::test

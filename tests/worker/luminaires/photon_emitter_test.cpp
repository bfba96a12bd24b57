// Which luminaire a photon starts from.
#include "luminaires/photon_emitter.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace nocturne {
namespace {

// One lamp of a square metre, one whose area is the ratio; the weak one may come first.
struct TwoLamps {
  std::vector<Luminaire> luminaires;
  Geometry geometry;
  LightSampler lights;
  PhotonEmitter emitter;

  TwoLamps(float ratio, bool weak_first)
      : geometry({quad_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                  quad_mesh({3, 0, 0}, {1, 0, 0}, {0, 1, 0})}),
        lights({}, {}, {}, {}, {}) {
    for (std::uint32_t i = 0; i < 2; ++i) {
      luminaires.emplace_back(i, Colour(Spectrum(1.0f)), false, LambertianProfile{});
      const float edge = weak_first == (i == 0) ? ratio : 1.0f;
      emitter.add_triangle(i, luminaires.back(), {{{{0, 0, 0}, {2.0f * edge, 0, 0}, {0, 1, 0}}}},
                           {Hit::kNoInstance, 0});
    }
    emitter.finish(lights, geometry.bounds());
  }

  std::optional<Emitted<1>> emit(float coarse, float fine) const {
    return emitter.emit<1>(luminaires, lights, geometry, geometry.bounds(), 0.0f, 0.0f, 550.0f,
                           {0.3f, 0.4f, coarse, fine}, {0.2f, 0.6f, 0.5f, 0.5f});
  }
};

// Photons from the weak lamp, times what each carries, are its flux: of all steps of the first
// number only one leads there, so the second decides.
TEST(PhotonEmitter, AWeakLampBesideAStrongOneEmitsItsFlux) {
  for (const float ratio : {1e-3f, 1e-8f, 1e-10f}) {
    for (const bool weak_first : {true, false}) {
      const TwoLamps lamps(ratio, weak_first);
      const std::uint32_t weak = weak_first ? 0 : 1;
      constexpr int kSteps = 1 << 16;
      // Where the interval of the weak one is, and as many steps of 2^-24 as it may need.
      const int coarse_steps = static_cast<int>(ratio * 0x1p24f) + 2;
      double flux = 0.0;
      int photons = 0;
      for (int c = 0; c < coarse_steps; ++c) {
        const int step = weak_first ? c : (1 << 24) - 1 - c;
        const int fine = coarse_steps > 100 ? 16 : kSteps;
        for (int i = 0; i < fine; ++i) {
          const auto emitted =
              lamps.emit(static_cast<float>(step) * 0x1p-24f,
                         (static_cast<float>(i) + 0.5f) / static_cast<float>(fine));
          if (!emitted || emitted->luminaire != weak) continue;
          ++photons;
          flux += static_cast<double>(emitted->flux[0]) * 0x1p-24 / fine;
        }
      }
      EXPECT_GT(photons, 0) << ratio;
      EXPECT_NEAR(flux / (static_cast<double>(kPi) * ratio), 1.0, 0.02) << ratio << weak_first;
    }
  }
}

// Of half axes 1, 1 and 2, mirrored, turned and elsewhere: its area is 2 pi (1 + 2 asin(e) / e)
// with e the root of 3/4. Points lie on it, and as densely as its surface of revolution has area.
TEST(PhotonEmitter, ASphereInAnInstanceEmitsAsTheEllipsoidThatItIs) {
  const Transform turned{0, 0, 2, 5, 1, 0, 0, -3, 0, -1, 0, 7};  // the group's z is the scene's x
  const Geometry geometry({Sphere{0.5, 0.0, 0.25, 1.0}}, {1}, {{1, {turned}}});
  const Double3 centre = geometry.instances()[0].placement(0.0f).point_to_scene({0.5, 0.0, 0.25});
  std::vector<Luminaire> luminaires;
  luminaires.emplace_back(0u, Colour(Spectrum(1.0f)), false, LambertianProfile{});
  PhotonEmitter emitter;
  emitter.add_sphere(0, luminaires[0], Sphere{0.5, 0.0, 0.25, 1.0}, geometry, 0);
  const LightSampler lights({}, {}, {}, {}, {});
  emitter.finish(lights, geometry.bounds());
  constexpr int kSteps = 512;
  double flux = 0.0, of_the_middle = 0.0;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const float u = (static_cast<float>(i % kSteps) + 0.5f) / kSteps;
    const float v = (static_cast<float>(i / kSteps) + 0.5f) / kSteps;
    const auto emitted =
        emitter.emit<1>(luminaires, lights, geometry, geometry.bounds(), 0.0f, 0.0f, 550.0f,
                        {u, v, 0.3f, 0.7f}, {0.2f, 0.6f, 0.5f, 0.5f});
    ASSERT_TRUE(emitted);
    const Double3 p = Double3(emitted->ray.origin) - centre;
    ASSERT_NEAR(p.x * p.x / 4.0 + p.y * p.y + p.z * p.z, 1.0, 1e-4);
    ASSERT_GT(emitted->ray.direction.x * p.x / 4.0 + emitted->ray.direction.y * p.y +
                  emitted->ray.direction.z * p.z,
              0.0);
    const double carried = emitted->flux[0] / (kSteps * kSteps);
    flux += carried;
    if (std::fabs(p.x) < 1.0) of_the_middle += carried;
  }
  const double e = std::sqrt(0.75), pi = std::numbers::pi;
  const double area = 2.0 * pi * (1.0 + 2.0 * std::asin(e) / e);
  EXPECT_NEAR(flux / (pi * area), 1.0, 2e-4);
  // Between x = -1 and 1: the integral of 2 pi sqrt(1 - 3 x^2 / 16).
  const double k = std::sqrt(3.0) / 4.0;
  const double middle = 2.0 * pi * (std::sqrt(1.0 - k * k) + std::asin(k) / k);
  EXPECT_NEAR(of_the_middle / (pi * middle), 1.0, 2e-3);
}

// Of an even sky all photons carry the same, wherever they come from: by the cosine with some axis
// those from across it had no bound, and no variance.
TEST(PhotonEmitter, AnEvenSkySendsPhotonsOfEqualFlux) {
  const std::vector<Luminaire> none;
  const Geometry geometry({quad_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0})});
  const LightSampler lights({}, Environment(Spectrum(2.0f)), {}, {}, {1, 1, 0});
  PhotonEmitter emitter;
  emitter.finish(lights, geometry.bounds());
  // Radiance times all directions times the ball's disc.
  const float radius = geometry.bounds().radius;
  const float flux =
      2.0f * 4.0f * std::numbers::pi_v<float> * std::numbers::pi_v<float> * radius * radius;
  for (int i = 0; i < 1000; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) * 1e-3f;
    const auto emitted = emitter.emit<1>(none, lights, geometry, geometry.bounds(), 0.0f, 0.0f,
                                         550.0f, {u, 0.4f, 0.5f, 0.5f}, {0.2f, 0.6f, 0.5f, 0.5f});
    ASSERT_TRUE(emitted);
    EXPECT_NEAR(emitted->flux[0], flux, 1e-4f * flux) << u;
  }
}

}  // namespace
}  // namespace nocturne

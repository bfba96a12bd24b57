#include "kernels/lambertian.h"

#include "support/chi_square.h"

namespace nocturne {
namespace {

constexpr int kCells = 400;

Shading<1> at(float nm) { return {.wavelengths = nm}; }

// Midpoint rule over the upper hemisphere, equal solid angles.
template <class F>
double integrate_hemisphere(const F& f) {
  double sum = 0.0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      sum += f(direction_from_z((static_cast<float>(i) + 0.5f) / kCells,
                                (static_cast<float>(j) + 0.5f) / kCells));
    }
  }
  return sum * 2.0 * std::numbers::pi / (kCells * kCells);
}

TEST(Lambertian, AlbedoIsTheIntegralOfItsValue) {
  const auto kernel = Lambertian{Colour(Spectrum(0.37f))}.bind(at(550.0f));
  const Vec3 wo{0.6f, 0.0f, 0.8f};
  EXPECT_NEAR(integrate_hemisphere([&](Vec3 wi) { return kernel.value(wo, wi)[0]; }),
              kernel.albedo(wo)[0], 1e-5);
}

TEST(Lambertian, IsReciprocal) {
  const auto kernel = Lambertian{Colour(Spectrum(0.5f))}.bind(at(550.0f));
  const Vec3 a{0.6f, 0.0f, 0.8f}, b{0.0f, 0.28f, 0.96f};
  EXPECT_FLOAT_EQ(kernel.value(a, b)[0] / b.z, kernel.value(b, a)[0] / a.z);
}

TEST(Lambertian, ReflectanceFollowsItsSpectrum) {
  const Lambertian kernel{Colour(Spectrum(500.0f, 100.0f, {0.2f, 0.4f}, false))};
  EXPECT_FLOAT_EQ(kernel.bind(at(550.0f)).reflectance[0], 0.3f);
  EXPECT_FLOAT_EQ(kernel.bind(at(400.0f)).reflectance[0], 0.2f);
  EXPECT_FLOAT_EQ(kernel.bind(at(700.0f)).reflectance[0], 0.4f);
}

}  // namespace
}  // namespace nocturne

#include "kernels/thin_film.h"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include "kernel_checks.h"
#include "kernels/conductor.h"
#include "kernels/dielectric.h"
#include "kernels/fresnel.h"
#include "kernels/mueller.h"

namespace nocturne {
namespace {

double cos_degrees(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

struct Stack {
  double wavelength, from, cosine;
  std::vector<FilmLayer> layers;
  Complex to;

  PolarisedShares shares() const { return film_shares(cosine, from, layers, to, wavelength); }
};

// Clear layers of random indices and thicknesses.
Stack clear(std::mt19937& chance, std::size_t layers, double from, double to) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Stack stack{300.0 + 2000.0 * u(chance), from, u(chance), {}, {to}};
  for (std::size_t i = 0; i < layers; ++i)
    stack.layers.push_back({{1.2 + 1.4 * u(chance)}, 3.0 * std::exp(7.0 * u(chance))});
  return stack;
}

// film_stacks.py says by which program.
TEST(ThinFilm, AgreesWithTransferMatricesOfAnotherProgram) {
  std::ifstream file(std::string(NOCTURNE_TESTS) + "/kernels/film_stacks.txt");
  int count = 0;
  double worst = 0.0;
  Stack stack;
  std::size_t layers = 0;
  while (file >> stack.wavelength >> stack.from >> stack.cosine >> layers) {
    stack.layers.resize(layers);
    for (FilmLayer& layer : stack.layers)
      file >> layer.index.re >> layer.index.im >> layer.thickness;
    PolarisedShares known{};
    file >> stack.to.re >> stack.to.im >> known.s.reflected >> known.s.transmitted >>
        known.p.reflected >> known.p.transmitted;
    const PolarisedShares found = stack.shares();
    for (const double off :
         {found.s.reflected - known.s.reflected, found.s.transmitted - known.s.transmitted,
          found.p.reflected - known.p.reflected, found.p.transmitted - known.p.transmitted}) {
      worst = std::max(worst, std::fabs(off));
    }
    ++count;
  }
  EXPECT_EQ(count, 1000);
  EXPECT_LT(worst, 1e-8);
}

// A quarter wave of MgF2 on BK7; (HL)^N H of 2.35 and 1.38 on 1.52 (H. A. Macleod, Thin-Film
// Optical Filters, chapter 6: ((1 - Y) / (1 + Y))^2, Y = (nH / nL)^2N nH^2 / ns).
TEST(ThinFilm, QuarterWavesReflectAsTheirAdmittance) {
  const FilmLayer mgf2{{1.38}, 550.0 / (4.0 * 1.38)};
  const PolarisedShares one = film_shares(1.0, 1.0, {&mgf2, 1}, {1.5168}, 550.0);
  const double root = (1.5168 - 1.38 * 1.38) / (1.5168 + 1.38 * 1.38);
  EXPECT_NEAR(one.unpolarised().reflected, root * root, 1e-13);
  for (const int pairs : {1, 3, 5, 7}) {
    std::vector<FilmLayer> layers;
    for (int i = 0; i < 2 * pairs + 1; ++i) {
      const double n = i % 2 == 0 ? 2.35 : 1.38;
      layers.push_back({{n}, 550.0 / (4.0 * n)});
    }
    const double y = std::pow(2.35 / 1.38, 2 * pairs) * 2.35 * 2.35 / 1.52;
    const double r = (1.0 - y) / (1.0 + y);
    EXPECT_NEAR(film_shares(1.0, 1.0, layers, {1.52}, 550.0).unpolarised().reflected, r * r, 1e-12);
  }
}

TEST(ThinFilm, WithoutLayersIsFresnel) {
  for (const double degrees : {0.0, 30.0, 56.0, 80.0, 89.9}) {
    const double c = cos_degrees(degrees);
    for (const double ratio : {1.5, 1.0 / 1.5, 1.0001, 4.0}) {
      EXPECT_NEAR(film_shares(c, 1.2, {}, {1.2 * ratio}, 550.0).unpolarised().reflected,
                  fresnel_dielectric(c, ratio), 1e-10);  // squares of nearly equal indices cancel
    }
    EXPECT_NEAR(film_shares(c, 1.2, {}, {1.2 * 0.2, 1.2 * 3.4}, 550.0).unpolarised().reflected,
                fresnel_conductor(c, 0.2, 3.4), 1e-12);
  }
}

TEST(ThinFilm, ClearLayersLoseNothing) {
  std::mt19937 chance(1);
  for (int i = 0; i < 3000; ++i) {
    const PolarisedShares found = clear(chance, static_cast<std::size_t>(i % 9),
                                        i % 2 == 0 ? 1.0 : 1.52, i % 3 == 0 ? 1.0 : 1.6)
                                      .shares();
    for (const Shares& each : {found.s, found.p}) {
      ASSERT_NEAR(each.reflected + each.transmitted, 1.0, 1e-12);
      ASSERT_GE(each.transmitted, 0.0);
    }
  }
}

// From both sides along the same path as much goes through, also where layers absorb; what is
// reflected is the same only where they don't.
TEST(ThinFilm, TransmitsTheSameFromBothSides) {
  std::mt19937 chance(2);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    Stack there = clear(chance, 4, 1.0, 1.5);
    const bool absorbs = i % 2 == 0;
    if (absorbs) there.layers[1].index.im = u(chance);
    const double sine = std::sqrt(1.0 - there.cosine * there.cosine) / 1.5;
    const Stack back{there.wavelength,
                     1.5,
                     std::sqrt(1.0 - sine * sine),
                     {there.layers.rbegin(), there.layers.rend()},
                     {1.0}};
    const PolarisedShares a = there.shares(), b = back.shares();
    ASSERT_NEAR(a.s.transmitted, b.s.transmitted, 1e-11);
    ASSERT_NEAR(a.p.transmitted, b.p.transmitted, 1e-11);
    if (!absorbs) {
      ASSERT_NEAR(a.s.reflected, b.s.reflected, 1e-11);
    }
    ASSERT_LE(a.s.reflected + a.s.transmitted, 1.0 + 1e-12);
  }
}

// Two prisms of glass with a gap of air, beyond the critical angle: Born and Wolf, section 1.6.4
// continued to a layer that is evanescent: T = 1 / (1 + F sinh^2), with s and p apart.
TEST(ThinFilm, ReflectsLessThanTotallyBeforeAnotherGlass) {
  constexpr double kIndex = 1.5, kWavelength = 600.0;
  const double angle = 50.0 * std::numbers::pi / 180.0, cosine = std::cos(angle);
  const double along = kIndex * std::sin(angle), decay = std::sqrt(along * along - 1.0);
  for (const double gap : {10.0, 100.0, 400.0, 3000.0}) {
    const FilmLayer air{{1.0}, gap};
    const PolarisedShares found = film_shares(cosine, kIndex, {&air, 1}, {kIndex}, kWavelength);
    const double sinh = std::sinh(2.0 * std::numbers::pi * gap * decay / kWavelength);
    const auto through = [&](double ratio) {
      const double half = 0.5 * (ratio + 1.0 / ratio);
      return 1.0 / (1.0 + half * half * sinh * sinh);
    };
    const double q = kIndex * cosine;
    EXPECT_NEAR(found.s.transmitted, through(q / decay), 1e-12);
    EXPECT_NEAR(found.p.transmitted, through(kIndex * kIndex * decay / q), 1e-12);
  }
  // Clear layers can't help where nothing can go on.
  const FilmLayer layer{{1.38}, 100.0};
  const Shares total = film_shares(cosine, kIndex, {&layer, 1}, {1.0}, kWavelength).unpolarised();
  EXPECT_EQ(total.transmitted, 0.0);
  EXPECT_NEAR(total.reflected, 1.0, 1e-14);
}

// Where a wave runs exactly along a layer's faces, along the boundary, and where it is evanescent
// or black for any length: numbers, and none above 1.
TEST(ThinFilm, HasNoPlaceWithoutANumber) {
  for (const double from : {1.0, 1.5}) {
    for (const double cosine :
         {0.0, 1e-9, cos_degrees(std::asin(1.0 / 1.5) * 180.0 / std::numbers::pi), 1.0}) {
      for (const Complex index : {Complex{1.0}, {1.5}, {0.05, 6.0}, {100.0}, {1e-3}, {1.5, 1e-9}}) {
        for (const double thickness : {1e-3, 1e2, 1e5}) {
          const FilmLayer layer{index, thickness};
          for (const Complex to : {Complex{1.0}, {1.5}, {0.2, 3.4}, {0.0, 1.0}}) {
            const Shares found = film_shares(cosine, from, {&layer, 1}, to, 200.0).unpolarised();
            ASSERT_GE(found.reflected, 0.0);
            ASSERT_GE(found.transmitted, 0.0);
            ASSERT_LE(found.reflected + found.transmitted, 1.0 + 1e-6);
          }
        }
      }
    }
  }
}

ThinFilm coating(bool absorbs) {
  return ThinFilm(
      {{Spectrum(1.38f), Spectrum(0.0f), 120.0},
       {Spectrum(500.0f, 200.0f, {2.4f, 2.2f}, false), Spectrum(absorbs ? 0.2f : 0.0f), 80.0}});
}

BoundDielectric<1> bound(const Dielectric& kernel, float from, float to,
                         Transport transport = Transport::kAdjoint) {
  return kernel.bind(Shading<1>{
      .wavelengths = 550.0f, .index_from = from, .index_to = to, .transport = transport});
}

// As for a bare boundary; the back has the layers in reverse.
TEST(ThinFilm, OnRoughGlassIsReciprocalUpToTheIndexSquared) {
  const float n = 1.5f;
  const Roughness rough{Scalar(0.4f), Scalar(0.4f)};
  for (const bool absorbs : {false, true}) {
    const Dielectric front{rough, coating(absorbs)}, back{rough, coating(absorbs).reversed()};
    const auto above = bound(front, 1.0f, n), below = bound(back, n, 1.0f);
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const auto u = test::numbers(i, 31);
      const Vec3 a = UniformHemisphere::sample(u[0], u[1]),
                 b = UniformHemisphere::sample(u[2], u[3]);
      const Vec3 down{b.x, b.y, -b.z}, up{a.x, a.y, -a.z};
      const double there = static_cast<double>(above.value(a, down)[0] / b.z);
      const double other = static_cast<double>(below.value(b, up)[0] / a.z);
      EXPECT_NEAR(there * static_cast<double>(n * n), other, 2e-3 * std::max(1e-3, other));
      const double f = static_cast<double>(above.value(a, b)[0] / b.z);
      EXPECT_NEAR(f, static_cast<double>(above.value(b, a)[0] / a.z), 1e-4 * std::max(1e-3, f));
    }
  }
}

// A mirror image, a refraction, and what layers swallow, by the same shares as above: each photon's
// mean weight, from both sides and in both directions of transport.
TEST(ThinFilm, OnSmoothGlassSharesOutTheLight) {
  for (const bool absorbs : {false, true}) {
    for (const bool inside : {false, true}) {
      for (const auto halves : {KernelNumbers::Halves::kNo, KernelNumbers::Halves::kYes}) {
        const ThinFilm film = inside ? coating(absorbs).reversed() : coating(absorbs);
        const float from = inside ? 1.5f : 1.0f, to = inside ? 1.0f : 1.5f;
        const Dielectric glass{{Scalar(0.0f), Scalar(0.0f)}, film};
        const auto kernel = bound(glass, from, to, Transport::kForward);
        for (const double degrees : {0.0, 35.0, 60.0}) {
          const Vec3 wo = test::direction(degrees);
          const Shares known = film.shares(static_cast<double>(wo.z), static_cast<double>(from),
                                           {static_cast<double>(to)}, 550.0f)
                                   .unpolarised();
          double reflected = 0.0, transmitted = 0.0;
          constexpr int kSteps = 20'000;
          for (int i = 0; i < kSteps; ++i) {
            const float part = (static_cast<float>(i) + 0.5f) / kSteps;
            const auto draw = kernel.sample(wo, {part, 0.0f, 0.0f, halves}, 0);
            ASSERT_TRUE(draw && draw->delta);
            (draw->wi.z > 0.0f ? reflected : transmitted) +=
                static_cast<double>(draw->factor[0]) / kSteps;
          }
          EXPECT_NEAR(reflected, known.reflected, 1e-4);
          EXPECT_NEAR(transmitted, known.transmitted, 1e-4);
        }
      }
    }
  }
}

// A soap bubble: the boundary between air and air mirrors, and what passes goes straight on.
TEST(ThinFilm, BetweenEqualIndicesIsSeen) {
  const ThinFilm soap({{Spectrum(1.33f), Spectrum(0.0f), 300.0}});
  const Dielectric bubble{{Scalar(0.0f), Scalar(0.0f)}, soap};
  const auto kernel = bound(bubble, 1.0f, 1.0f);
  const Vec3 wo = test::direction(40.0, 10.0);
  const auto back = kernel.sample(wo, {0.0f, 0.0f, 0.0f}, 0);
  const auto on = kernel.sample(wo, {0.999f, 0.0f, 0.0f}, 0);
  ASSERT_TRUE(back && on);
  EXPECT_GT(back->wi.z, 0.0f);
  EXPECT_NEAR(on->wi.x, -wo.x, 1e-6);
  EXPECT_NEAR(on->wi.z, -wo.z, 1e-6);
}

TEST(ThinFilm, WithoutLayersPolarisesAsAFaceDoes) {
  for (const float ratio : {0.5f, 0.7f, 0.999f, 1.001f, 1.33f, 1.5f, 2.4f}) {
    for (const float cosine : {0.02f, 0.3f, 0.5547f, 0.7f, 0.76f, 0.9f, 1.0f}) {
      const PolarisedAmplitudes by =
          film_amplitudes(static_cast<double>(cosine), 1.0, {}, {static_cast<double>(ratio)}, 1.0);
      const bool totally = 1.0f - cosine * cosine > ratio * ratio;
      for (const bool reflects : {true, false}) {
        if (totally && !reflects) continue;
        Mueller<1> face, stack;
        face.set_face(0, cosine, ratio, reflects);
        if (reflects) {
          stack.set(0, by.s.reflected, by.p.reflected);
        } else {
          stack.set(0, by.s.transmitted, by.p.transmitted);
        }
        EXPECT_NEAR(face.b[0], stack.b[0], 2e-6) << ratio << ' ' << cosine;
        EXPECT_NEAR(face.c[0], stack.c[0], 2e-6) << ratio << ' ' << cosine;
        EXPECT_NEAR(face.d[0], stack.d[0], 2e-6) << ratio << ' ' << cosine;
        EXPECT_NEAR(face.s[0], stack.s[0], 2e-6) << ratio << ' ' << cosine;
        EXPECT_EQ(face.a[0], 1.0f);
      }
    }
  }
}

TEST(ThinFilm, OnMetalIsThatOfTheStack) {
  const ThinFilm oxide({{Spectrum(1.46f), Spectrum(0.0f), 90.0}});
  const Conductor metal{Spectrum(0.96f), Spectrum(6.69f), {Scalar(0.0f), Scalar(0.0f)}, oxide};
  const Vec3 wo = test::direction(50.0);
  const auto draw = metal.bind(Shading<1>{.wavelengths = 550.0f}).sample(wo, {}, 0);
  const FilmLayer layer{{static_cast<double>(1.46f)}, 90.0};
  const double known = film_shares(static_cast<double>(wo.z), 1.0, {&layer, 1},
                                   {static_cast<double>(0.96f), static_cast<double>(6.69f)}, 550.0)
                           .unpolarised()
                           .reflected;
  EXPECT_NEAR(draw->factor[0], known, 1e-6);
}

}  // namespace
}  // namespace nocturne

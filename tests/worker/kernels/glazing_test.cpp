#include "kernels/glazing.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"
#include "kernels/thin_pane.h"

namespace nocturne {
namespace {

ThinFilm silver() {
  return ThinFilm({{Spectrum(2.0f), Spectrum(0.0f), 40.0},
                   {Spectrum(0.06f), Spectrum(3.6f), 12.0},
                   {Spectrum(2.0f), Spectrum(0.01f), 35.0}});
}

Shares of(const Glazing& glazing, double degrees) {
  return glazing.shares(static_cast<double>(test::direction(degrees).z), 1.0f, 550.0f);
}

// EN 410:2011, 5.2, two panes of numbers: tau = t1 t2 / (1 - r1' r2), rho = r1 + t1^2 r2 / (1 - r1'
// r2). Clear glass of 3 mm, T 0.899 and R 0.083 (Generic clear, International Glazing Database
// 102): the double pane has T 0.814 and R 0.150 in WINDOW's library.
TEST(Glazing, TwoMeasuredPanesAreAsPublished) {
  const auto clear = [] {
    return MeasuredPane{Spectrum(0.083f), Spectrum(0.083f), Spectrum(0.899f)};
  };
  const Shares two = of(Glazing({clear(), clear()}), 0.0);
  EXPECT_NEAR(two.transmitted, 0.899 * 0.899 / (1.0 - 0.083 * 0.083), 1e-6);
  EXPECT_NEAR(two.transmitted, 0.814, 5e-4);
  EXPECT_NEAR(two.reflected, 0.150, 1e-3);
  const MeasuredPane coated{Spectrum(0.05f), Spectrum(0.11f), Spectrum(0.78f)};
  const Shares mixed = of(Glazing({coated, clear()}), 0.0);
  const double echo = 1.0 - static_cast<double>(0.11f) * static_cast<double>(0.083f);
  EXPECT_NEAR(mixed.transmitted, 0.78 * 0.899 / echo, 1e-6);
  EXPECT_NEAR(mixed.reflected, 0.05 + 0.78 * 0.78 * 0.083 / echo, 1e-6);
}

// Bare sheets against the pile of plates, T = (1 - R) / (1 + (2 N - 1) R) of each polarisation
// (Stokes 1862), R of one face.
TEST(Glazing, BareSheetsAreAPileOfPlates) {
  const auto sheet = [] { return SheetPane{Spectrum(1.5f), Spectrum(1.0f), {}, {}}; };
  for (const double degrees : {0.0, 40.0, 56.309932, 75.0}) {
    const PolarisedShares face =
        film_shares(static_cast<double>(test::direction(degrees).z), 1.0, {}, {1.5}, 550.0);
    std::vector<Pane> panes;
    for (int n = 1; n <= 5; ++n) {
      panes.emplace_back(sheet());
      const auto through = [&](double r) { return (1.0 - r) / (1.0 + (2 * n - 1) * r); };
      const Shares found = of(Glazing(panes), degrees);
      EXPECT_NEAR(found.transmitted, 0.5 * (through(face.s.reflected) + through(face.p.reflected)),
                  1e-12);
      EXPECT_NEAR(found.reflected + found.transmitted, 1.0, 1e-12);
    }
  }
}

// At normal incidence there are no polarisations to keep apart.
TEST(Glazing, OneBareSheetAlongTheNormalIsAThinPane) {
  const Glazing one({SheetPane{Spectrum(1.52f), Spectrum(0.9f), {}, {}}});
  const PaneShares pane = pane_shares(1.0, static_cast<double>(1.52f), static_cast<double>(0.9f));
  EXPECT_NEAR(of(one, 0.0).transmitted, pane.transmitted, 1e-7);
  EXPECT_NEAR(of(one, 0.0).reflected, pane.reflected, 1e-7);
}

// What goes through is the same from both sides; energy is lost only in what absorbs.
TEST(Glazing, IsReciprocal) {
  const std::vector<Pane> panes{SheetPane{Spectrum(1.52f), Spectrum(0.95f), {}, silver()},
                                MeasuredPane{Spectrum(0.05f), Spectrum(0.2f), Spectrum(0.7f)},
                                FilmPane{ThinFilm({{Spectrum(1.33f), Spectrum(0.0f), 400.0},
                                                   {Spectrum(1.5f), Spectrum(0.1f), 100.0}})}};
  std::vector<Pane> turned{FilmPane{std::get<FilmPane>(panes[2]).film.reversed()},
                           MeasuredPane{Spectrum(0.2f), Spectrum(0.05f), Spectrum(0.7f)},
                           SheetPane{Spectrum(1.52f), Spectrum(0.95f), silver(), {}}};
  const Glazing front(panes), back(turned);
  for (const double degrees : {0.0, 30.0, 60.0, 85.0, 89.9}) {
    const Shares a = of(front, degrees), b = of(back, degrees);
    EXPECT_NEAR(a.transmitted, b.transmitted, 1e-12) << degrees;
    EXPECT_LE(a.reflected + a.transmitted, 1.0);
    EXPECT_LE(b.reflected + b.transmitted, 1.0);
    EXPECT_GE(a.transmitted, 0.0);
  }
  EXPECT_GT(std::fabs(of(front, 0.0).reflected - of(back, 0.0).reflected), 0.01);
}

// Measured shares at an angle end at a mirror, and never make light; the fits' own digits for clear
// glass at 60 degrees, 0.898 of the normal transmittance.
TEST(Glazing, MeasuredSharesDependOnTheAngle) {
  for (const double through : {0.9, 0.5}) {
    const LayerShares normal{0.05, 0.1, through};
    const LayerShares along = measured_shares(normal, 1.0);
    EXPECT_NEAR(along.front, 0.05, 1e-12);
    EXPECT_NEAR(along.back, 0.1, 1e-12);
    EXPECT_NEAR(along.through, through, 1e-12);
    for (int i = 0; i <= 100; ++i) {
      const LayerShares at = measured_shares({0.1, 1.0 - through, through}, 0.01 * i);
      EXPECT_LE(at.back + at.through, 1.0 + 1e-12);
      EXPECT_GE(at.front, 0.0);
    }
    // The fits end at 0.992 and 0.998.
    EXPECT_NEAR(measured_shares(normal, 0.0).front, 1.0, 1e-2);
    EXPECT_NEAR(measured_shares(normal, 0.0).through, 0.0, 1e-12);
  }
  const double cosine = 0.5,
               fitted = -0.0015 + 3.355 * cosine - 3.840 * 0.25 + 1.460 * 0.125 + 0.0288 * 0.0625;
  EXPECT_NEAR(measured_shares({0.08, 0.081, 0.8}, cosine).through, 0.8 * fitted / 1.0023, 1e-12);
  // Bare clear glass of index 1.52 by Fresnel: 0.906 of its normal transmittance.
  EXPECT_NEAR(fitted / 1.0023, 0.906, 0.012);
}

TEST(Glazing, DrawsWeighTheirShares) {
  const Glazing glazing({SheetPane{Spectrum(1.52f), Spectrum(0.9f), silver(), {}}});
  const auto kernel = glazing.bind(Shading<4>{.wavelengths = test::lanes(450, 500, 550, 700)});
  const Vec3 wo = test::direction(50.0, 20.0);
  for (std::size_t lane = 0; lane < 4; ++lane) {
    double reflected = 0.0, transmitted = 0.0;
    constexpr int kSteps = 10'000;
    for (int i = 0; i < kSteps; ++i) {
      const auto draw = kernel.sample(wo, {(static_cast<float>(i) + 0.5f) / kSteps, 0, 0}, 0);
      (draw->wi.z > 0.0f ? reflected : transmitted) +=
          static_cast<double>(draw->factor[lane]) / kSteps;
    }
    const Shares known = glazing.shares(static_cast<double>(wo.z), 1.0f, kernel.wavelengths[lane]);
    EXPECT_NEAR(reflected, known.reflected, 3e-4);
    EXPECT_NEAR(transmitted, known.transmitted, 3e-4);
  }
}

}  // namespace
}  // namespace nocturne

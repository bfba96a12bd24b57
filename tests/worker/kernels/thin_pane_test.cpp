#include "kernels/thin_pane.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"

namespace nocturne {
namespace {

struct Row {
  double degrees, transmitted, reflected;
};
struct Pane {
  double index, depth;
  std::vector<Row> rows;
};

// Incoherent sum of all internal reflections, unpolarised at every bounce; all digits from an
// independent evaluation (Airy summation without interference).
const std::vector<Pane> kPanes{{1.52,
                                0.0,
                                {{0, 0.91831803, 0.081681972},
                                 {15, 0.91816505, 0.081834951},
                                 {30, 0.91544553, 0.084554472},
                                 {45, 0.89925365, 0.10074635},
                                 {60, 0.8306926, 0.1693074},
                                 {75, 0.59145026, 0.40854974},
                                 {85, 0.23844877, 0.76155123}}},
                               {1.5168,
                                0.0,
                                {{0, 0.91908272, 0.080917283},
                                 {15, 0.9189303, 0.081069702},
                                 {30, 0.91621957, 0.083780428},
                                 {45, 0.9000659, 0.099934096},
                                 {60, 0.83157163, 0.16842837},
                                 {75, 0.59217429, 0.40782571},
                                 {85, 0.23869859, 0.76130141}}},
                               {1.8,
                                0.05,
                                {{0, 0.80713235, 0.14430759},
                                 {15, 0.80653706, 0.1444082},
                                 {30, 0.8024215, 0.14709473},
                                 {45, 0.78437017, 0.16299788},
                                 {60, 0.71895575, 0.22607921},
                                 {75, 0.51015587, 0.43365005},
                                 {85, 0.19939659, 0.74758414}}}};

TEST(ThinPane, SharesAreAsPublished) {
  for (const Pane& pane : kPanes) {
    SCOPED_TRACE(pane.index);
    for (const Row& row : pane.rows) {
      const auto shares = pane_shares(std::cos(row.degrees * std::numbers::pi / 180.0), pane.index,
                                      std::exp(-pane.depth));
      EXPECT_NEAR(shares.transmitted, row.transmitted, 1e-8) << row.degrees;
      EXPECT_NEAR(shares.reflected, row.reflected, 1e-8) << row.degrees;
    }
  }
}

TEST(ThinPane, DrawsCarryTheShares) {
  const ThinPane pane(Spectrum(400.0f, 300.0f, {1.55f, 1.5f}, false),
                      Spectrum(400.0f, 300.0f, {0.2f, 1.0f}, false));
  const auto kernel =
      pane.bind(Shading<4>{.wavelengths = test::lanes(400.0f, 500.0f, 600.0f, 700.0f)});
  const Vec3 wo = test::direction(40.0, 70.0);
  double reflected = 0.0, transmitted = 0.0;
  constexpr std::uint32_t kDraws = 1u << 16;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const auto draw = kernel.sample(wo, {(static_cast<float>(i) + 0.5f) / kDraws, 0.0f, 0.0f}, 2);
    ASSERT_TRUE(draw && draw->delta);
    EXPECT_EQ(draw->coherent, 15u);
    (draw->wi.z > 0.0f ? reflected : transmitted) += static_cast<double>(draw->factor[1]) / kDraws;
    if (draw->wi.z < 0.0f) {
      EXPECT_EQ(draw->wi.x, -wo.x);
    }
  }
  const auto shares = pane_shares(static_cast<double>(wo.z), static_cast<double>(kernel.ratio[1]),
                                  static_cast<double>(kernel.transmittance[1]));
  EXPECT_NEAR(reflected, shares.reflected, 1e-3);
  EXPECT_NEAR(transmitted, shares.transmitted, 1e-3);
  EXPECT_NEAR(kernel.albedo(wo)[1], shares.reflected + shares.transmitted, 1e-6);
}

TEST(ThinPane, TotalReflectionAndBlackGlassAreFinite) {
  EXPECT_EQ(pane_shares(0.01, 1.0 / 1.5, 1.0).reflected, 1.0);
  EXPECT_EQ(pane_shares(0.5, 1.5, 0.0).transmitted, 0.0);
  EXPECT_NEAR(pane_shares(0.5, 1.5, 0.0).reflected, fresnel_dielectric(0.5, 1.5), 1e-15);
}

}  // namespace
}  // namespace nocturne

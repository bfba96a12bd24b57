// The tree over luminaires: whom it chooses, against chances and sums by brute force.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "luminaires/area_light_sampler.h"
#include "support/chi_square.h"
#include "support/irradiance.h"

namespace nocturne {
namespace {

// 10,000 small lamps of all orientations, a hundredfold apart in radiance, in a box of 20 m x 20 m
// x 10 m. Each is taken as one point, so that only the noise of choosing remains.
struct ManyLamps {
  static constexpr std::uint32_t kCount = 10'000;
  Elements elements;
  std::vector<float> radiances;

  ManyLamps() {
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const auto u = test::numbers(i, 7), v = test::numbers(i, 8);
      const Vec3 centre{20 * u[0] - 10, 20 * u[1] - 10, 5 + 10 * u[2]};
      const Vec3 a = 0.05f * UniformSphere::sample(v[0], v[1]);
      const Vec3 b = 0.05f * UniformSphere::sample(v[2], v[3]);
      const std::array<Vec3, 3> c{centre, centre + a, centre + b};
      radiances.push_back(std::pow(10.0f, 2.0f * u[3]));
      elements.add_triangle({&c, 1}, {radiances.back(), i % 4 == 0, i % 7 == 0 ? 3.0f : 0.0f});
    }
  }

  // Irradiance from the point that is drawn from the middle of the unit square.
  double contribution(std::size_t i, const LightSamplingContext& from) const {
    const ElementBounds& b = elements.bounds(i);
    const auto drawn = elements.sample(i, from, 0.5f, 0.5f);
    if (!drawn || !from.sees(drawn->direction)) return 0.0;
    const Vec3 w = drawn->direction;
    const double pdf = elements.pdf(i, from, w), cosine = std::fabs(dot(b.axis, w));
    if (!(pdf > 0.0)) return 0.0;
    return radiances[i] * std::pow(cosine, b.cosine_power) * dot(from.normal, w) / pdf;
  }
};

// Draws follow the probabilities that the tree claims, lamps that are never drawn bring no light,
// and the sum over lamps is the one by brute force. Below all lamps, and in their midst.
TEST(LightTree, TenThousandLamps) {
  const ManyLamps lamps;
  ASSERT_EQ(lamps.elements.size(), ManyLamps::kCount);
  const AreaLightSampler directions(lamps.elements);
  const LightTree& tree = directions.tree();
  for (const LightSamplingContext& from :
       {LightSamplingContext{{0, 0, 0}, {0, 0, 1}},
        LightSamplingContext{{0, 0, 10}, normalized({1, 1, -1})}}) {
    std::vector<double> contribution, probability;
    double truth = 0.0, claimed = 0.0, by_tree = 0.0, by_power = 0.0;
    for (std::uint32_t i = 0; i < lamps.elements.size(); ++i) {
      const double c = lamps.contribution(i, from), p = tree.probability(from, i);
      contribution.push_back(c);
      probability.push_back(p);
      truth += c;
      claimed += p;
      if (!(c > 0.0)) continue;
      ASSERT_GT(p, 0.0) << "a lamp that shines is never chosen";
      by_tree += c * c / p;
      by_power += c * c / lamps.elements.bounds(i).weight * lamps.elements.total_weight();
    }
    // Where all below a node turns out to be invisible, nothing is drawn.
    EXPECT_LE(claimed, 1.0 + 1e-4);
    const double tree_spread = std::sqrt(by_tree / (truth * truth) - 1.0);
    const double power_spread = std::sqrt(by_power / (truth * truth) - 1.0);
    std::printf("spread by tree %.3f, by power %.3f; drawn %.3f\n", tree_spread, power_spread,
                claimed);
    EXPECT_LT(tree_spread, 0.8 * power_spread);

    constexpr std::uint32_t kDraws = 400'000;
    std::vector<double> observed(contribution.size() + 1), expected(contribution.size() + 1);
    const test::Estimate drawn = test::estimate(kDraws, [&](const Uniform4& u) {
      const auto chosen = tree.choose(from, u[0]);
      observed[chosen ? chosen->element : contribution.size()] += 1.0;
      if (!chosen) return 0.0;
      EXPECT_TRUE(chosen->choice >= 0.0f && chosen->choice < 1.0f);
      return contribution[chosen->element] / probability[chosen->element];
    });
    for (std::size_t i = 0; i < probability.size(); ++i) expected[i] = probability[i] * kDraws;
    expected.back() = std::max(0.0, 1.0 - claimed) * kDraws;
    test::expect_same_counts(observed, expected);
    test::expect_mean(drawn, truth);
  }
}

}  // namespace
}  // namespace nocturne

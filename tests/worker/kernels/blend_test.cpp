#include "kernels/blend.h"

#include <gtest/gtest.h>

#include "kernel_checks.h"
#include "kernels/any_kernel.h"

namespace nocturne {
namespace {

const std::vector<AnyKernel>& kernels() {
  static const std::vector<AnyKernel> all{
      Lambertian{Colour(Spectrum(0.5f))}, NullKernel{},
      Conductor{Spectrum(0.0f), Spectrum(1.0f), {Scalar(0.0f), Scalar(0.0f)}},
      Blend{{{0, {{Scalar(0.25f), false}}}, {1, {{Scalar(0.25f), true}}}}},
      Blend{{{0, {{Scalar(0.5f), false}, {Scalar(0.4f), false}}},
             {1, {{Scalar(0.5f), false}, {Scalar(0.4f), true}}},
             {2, {{Scalar(0.5f), true}}}}}};
  return all;
}

TEST(Blend, OpacityLetsTheRestThrough) {
  visit_bound<1>(kernels(), 3, Shading<1>{.wavelengths = 550.0f}, [](const auto& kernel) {
    const Vec3 wo = test::direction(30.0);
    EXPECT_TRUE(kernel.smooth());
    EXPECT_NEAR(Spectral<1>(kernel.albedo(wo))[0], 0.25 * 0.5 + 0.75, 1e-6);
    const auto passed = test::mean_of(20'000, [&](std::uint32_t i) {
      const auto draw = kernel.sample(wo, test::kernel_numbers(test::numbers(i, 2)), 0);
      return draw && draw->delta ? static_cast<double>(draw->factor[0]) : 0.0;
    });
    EXPECT_NEAR(passed.value, 0.75, 4.0 * passed.standard_error);
  });
}

TEST(Blend, DrawsGiveTheSumOfParts) {
  visit_bound<1>(kernels(), 4, Shading<1>{.wavelengths = 550.0f}, [](const auto& kernel) {
    const auto mean = test::sampled_albedo(kernel, test::direction(30.0), 50'000);
    EXPECT_NEAR(mean.value, 0.2 * 0.5 + 0.3 + 0.5, 4.0 * mean.standard_error);
  });
}

TEST(Blend, IsChecked) {
  EXPECT_NO_THROW(check_blends(kernels()));
  const auto refused = [](Blend blend) {
    std::vector<AnyKernel> all{NullKernel{}, Blend{{{0, {}}}}};
    all.emplace_back(std::move(blend));
    EXPECT_THROW(check_blends(all), std::invalid_argument);
  };
  refused({});
  refused({{{1, {}}}});
  refused({{{3, {}}}});
  refused({std::vector<Blend::Part>(9, Blend::Part{0, {}})});
}

}  // namespace
}  // namespace nocturne

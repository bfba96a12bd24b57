// What every kernel must hold, for all of them: density, energy, agreement with uniform draws,
// groups, and no value that isn't a number.
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "kernel_checks.h"
#include "kernels/any_kernel.h"
#include "measured_blob.h"
#include "support/chi_square.h"
#include "support/effort.h"

namespace nocturne {
namespace {

struct Named {
  std::string name;
  std::size_t index;
  float index_to = 1.5f;
};

Roughness rough(float u, float v) { return {Scalar(u), Scalar(v)}; }
Spectrum line(float blue, float red) { return {400.0f, 300.0f, {blue, red}, false}; }

class Shown {
 public:
  Shown() {
    add("lambertian", Lambertian{Colour(line(0.2f, 0.8f))});
    add("transmitter", DiffuseTransmitter(Colour(line(0.2f, 0.6f)), Colour(line(0.5f, 0.1f))));
    for (const auto& [u, v] :
         {std::pair{0.01f, 0.01f}, {0.1f, 0.1f}, {0.5f, 0.5f}, {1.0f, 1.0f}, {0.1f, 0.5f}}) {
      const auto alpha =
          std::string(" ").append(std::to_string(u)).append(" ").append(std::to_string(v));
      add("conductor" + alpha, Conductor{line(0.2f, 1.5f), line(3.0f, 4.0f), rough(u, v)});
      add("glass" + alpha, Dielectric{rough(u, v)});
      add("glass from inside" + alpha, Dielectric{rough(u, v)}, 1.0f / 1.5f);
      add("coated" + alpha, CoatedDiffuse(line(1.6f, 1.4f), rough(u, v), Colour(line(0.2f, 0.9f))));
    }
    add("mirror", Conductor{line(0.2f, 1.5f), line(3.0f, 4.0f), rough(0.0f, 0.0f)});
    add("smooth glass", Dielectric{rough(0.0f, 0.0f)});
    add("pane", ThinPane(line(1.55f, 1.5f), line(0.9f, 0.5f)));
    add("smooth coat",
        CoatedDiffuse(line(1.6f, 1.4f), rough(0.0f, 0.0f), Colour(line(0.2f, 0.9f))));
    add("measured", test::glossy_blob().kernel());
    for (const float n : {0.0f, 10.0f, 1000.0f})
      add("phong " + std::to_string(n), Phong{Colour(line(0.5f, 1.0f)), n});
    add("null kernel", NullKernel{});
    const auto film = [](float k) {
      return ThinFilm(
          {{line(1.4f, 1.36f), Spectrum(0.0f), 130.0}, {line(2.4f, 2.2f), Spectrum(k), 300.0}});
    };
    for (const float alpha : {0.0f, 0.1f, 0.5f}) {
      const auto as = " " + std::to_string(alpha);
      add("coated metal" + as,
          Conductor{line(0.2f, 1.5f), line(3.0f, 4.0f), rough(alpha, alpha), film(0.0f)});
      for (const float k : {0.0f, 0.1f}) {
        add("coated glass" + as, Dielectric{rough(alpha, 2.0f * alpha), film(k)});
        add("coated glass from inside" + as, Dielectric{rough(alpha, 2.0f * alpha), film(k)},
            1.0f / 1.5f);
      }
    }
    add("soap bubble", Dielectric{rough(0.0f, 0.0f), film(0.0f)}, 1.0f);
    add("glazing", Glazing({SheetPane{line(1.55f, 1.5f), line(0.9f, 0.5f), film(0.1f), {}},
                            MeasuredPane{line(0.1f, 0.3f), Spectrum(0.2f), line(0.7f, 0.5f)}}));
    for (const auto& [metallic, roughness, coat] : {std::tuple{0.0f, 0.5f, 0.0f},
                                                    {0.5f, 0.3f, 0.8f},
                                                    {1.0f, 0.7f, 0.0f},
                                                    {1.0f, 0.0f, 1.0f}}) {
      add("principled " + std::to_string(metallic) + " " + std::to_string(coat),
          Principled(Colour(line(0.2f, 0.9f)), Scalar(metallic), Scalar(roughness),
                     line(1.6f, 1.4f), {Scalar(coat), Scalar(0.4f), 1.5f}));
    }
    for (const float metallic : {0.0f, 0.6f, 1.0f}) {
      add("principled with everything " + std::to_string(metallic),
          Principled(
              Colour(line(0.2f, 0.9f)), Scalar(metallic), Scalar(0.3f), line(1.6f, 1.4f),
              {Scalar(0.5f), Scalar(0.4f), 1.5f},
              {.reflectance = Principled::Reflectance{Scalar(0.8f), Colour(line(0.5f, 0.1f))},
               .brush = Principled::Brush{Scalar(0.7f), Scalar(0.1f)},
               .sheen = Principled::Fuzz{Colour(line(0.1f, 0.8f)), Scalar(0.4f)}}));
    }
    for (const double g : {-0.5, 0.0, 0.8}) {
      add("phase " + std::to_string(g),
          Phase{line(1.0f, 2.0f), line(4.0f, 1.0f), HenyeyGreenstein(g)});
    }
    add("molecules", Phase{Spectrum(0.0f), line(4.0f, 1.0f), RayleighPhase(std::nullopt)});
    add("fluorescent", Fluorescent{Colour(line(0.2f, 0.5f)), {}});
    add("filter",
        PolarisingFilter{line(0.9f, 0.7f), line(0.1f, 0.0f), line(1.0f, 2.0f), {0, 0, 1}});
    // Lambertian, conductor 0.1, smooth glass and the null kernel.
    const auto glass = static_cast<std::uint32_t>(find("smooth glass"));
    for (const auto& [u, v] : {std::pair{0.05f, 0.05f}, {0.5f, 0.5f}, {1.0f, 0.1f}}) {
      const Roughness roughness{Scalar(u), Scalar(v), FacetDistribution::kBeckmann};
      const auto alpha =
          std::string(" beckmann ").append(std::to_string(u)).append(" ").append(std::to_string(v));
      add("conductor" + alpha, Conductor{line(0.2f, 1.5f), line(3.0f, 4.0f), roughness});
      add("glass" + alpha, Dielectric{roughness});
      add("glass from inside" + alpha, Dielectric{roughness}, 1.0f / 1.5f);
      add("coated" + alpha, CoatedDiffuse(line(1.6f, 1.4f), roughness, Colour(line(0.2f, 0.9f))));
    }
    add("blend", Blend{{{0, {{Scalar(0.5f), false}}},
                        {6, {{Scalar(0.5f), true}, {Scalar(0.5f), false}}},
                        {glass, {{Scalar(0.5f), true}, {Scalar(0.5f), true}}}}});
  }

  std::size_t find(const std::string& name) const {
    for (const Named& n : named) {
      if (n.name == name) return n.index;
    }
    throw std::invalid_argument(name);
  }

  std::vector<AnyKernel> kernels;
  std::vector<Named> named;

 private:
  void add(const std::string& name, AnyKernel kernel, float index_to = 1.5f) {
    named.push_back({name, kernels.size(), index_to});
    kernels.push_back(std::move(kernel));
  }
};

const Shown& shown() {
  static const Shown all;
  return all;
}

template <int N>
Shading<N> shading(const Named& named, Transport transport = Transport::kForward) {
  Shading<N> s{.wavelengths = 550.0f, .index_to = named.index_to, .transport = transport};
  for (std::size_t i = 0; i < N; ++i) s.wavelengths[i] = 550.0f + 20.0f * static_cast<float>(i);
  return s;
}

// Each half of the sphere with cells around where a smooth surface would send light. 248 tests in
// all: a false alarm in 1 of 120 sets of other seeds. `make test` has half of the angles.
TEST(AllKernels, SamplesMatchPdf) {
  using Degrees = std::vector<double>;
  const Degrees shown_degrees =
      test::in_full() ? Degrees{0.0, 30.0, 75.0, 89.9} : Degrees{30.0, 89.9};
  for (const Named& named : shown().named) {
    for (const double degrees : shown_degrees) {
      const Vec3 wo = test::direction(degrees, 20.0);
      const auto s = shading<1>(named);
      visit_bound<1>(shown().kernels, named.index, s, [&](const auto& kernel) {
        if (!kernel.smooth()) return;
        for (const float side : {1.0f, -1.0f}) {
          if (side < 0.0f && !kernel.transmits()) continue;
          SCOPED_TRACE(named.name + " at " + std::to_string(degrees) +
                       (side > 0 ? " above" : " below"));
          Vec3 axis{-wo.x, -wo.y, wo.z};
          if (side < 0.0f) {
            const float x = -wo.x / named.index_to, y = -wo.y / named.index_to;
            axis = {x, y, -std::sqrt(std::max(0.0f, 1.0f - x * x - y * y))};
            axis = normalized(axis);
          }
          test::expect_samples_match_pdf(
              [&](const Uniform4& u) -> std::optional<Vec3> {
                const auto draw = kernel.sample(wo, test::kernel_numbers(u), 0);
                if (!draw || draw->delta || draw->wi.z * side <= 0.0f) return std::nullopt;
                return draw->wi;
              },
              [&](Vec3 wi) {
                return wi.z * side > 0.0f ? Spectral<1>(kernel.pdf(wo, wi))[0] : 0.0f;
              },
              24, {.axis = axis, .power = 4.0}, 50'000);
        }
      });
    }
  }
}

TEST(AllKernels, ConserveEnergy) {
  for (const Named& named : shown().named) {
    for (const double degrees : {0.0, 50.0, 85.0, 89.9}) {
      visit_bound<1>(shown().kernels, named.index, shading<1>(named), [&](const auto& kernel) {
        const auto mean = test::sampled_albedo(kernel, test::direction(degrees, 10.0), 5'000);
        // 140 comparisons; 1e-3: the rough coat's table
        EXPECT_LE(mean.value, 1.0 + 4.5 * mean.standard_error + 1e-3) << named.name << degrees;
      });
    }
  }
}

// The sum over the smooth part, by the kernel's draws and by uniform directions.
TEST(AllKernels, DrawsAgreeWithUniformOnes) {
  for (const Named& named : shown().named) {
    const Vec3 wo = test::direction(50.0, 10.0);
    visit_bound<1>(shown().kernels, named.index, shading<1>(named), [&](const auto& kernel) {
      if (!kernel.smooth()) return;
      const auto own = test::mean_of(test::part_of(100'000), [&](std::uint32_t i) {
        const auto u = test::kernel_numbers(test::numbers(i, 4));
        const auto draw = kernel.sample(wo, u, 0);
        return draw && !draw->delta ? test::weight(kernel, wo, u) : 0.0;
      });
      const auto uniform = test::mean_of(test::part_of(100'000), [&](std::uint32_t i) {
        const auto u = test::numbers(i, 5);
        const Vec3 wi = UniformSphere::sample(u[0], u[1]);
        return static_cast<double>(Spectral<1>(kernel.value(wo, wi))[0] / UniformSphere::pdf());
      });
      const double error = std::hypot(own.standard_error, uniform.standard_error);
      // Alpha 0.01 is hit by too few uniform directions for a normal deviate.
      if (named.name.find("0.010000") != std::string::npos || named.name == "phong 1000.000000")
        return;
      // Beside chance, single precision.
      EXPECT_NEAR(own.value, uniform.value, 4.5 * error + 1e-6 * uniform.value) << named.name;
    });
  }
}

TEST(AllKernels, AGroupIsFourPhotons) {
  for (const Named& named : shown().named) {
    for (const float spread : {0.0f, 0.01f}) {
      auto s4 = shading<4>(named);
      for (std::size_t i = 0; i < 4; ++i) s4.index_to[i] += spread * static_cast<float>(i / 2);
      visit_bound<4>(shown().kernels, named.index, s4, [&](const auto& group) {
        for (std::size_t lane = 0; lane < 4; ++lane) {
          Shading<1> s1{.wavelengths = s4.wavelengths[lane],
                        .index_to = s4.index_to[lane],
                        .transport = s4.transport};
          visit_bound<1>(shown().kernels, named.index, s1, [&](const auto& single) {
            for (std::uint32_t i = 0; i < 50; ++i) {
              const auto u = test::kernel_numbers(test::numbers(i, 6));
              const Vec3 wo = test::direction(5.0 + i, 3.0 * i);
              ASSERT_EQ(Spectral<4>(group.albedo(wo))[lane], Spectral<1>(single.albedo(wo))[0]);
              const auto of_group = group.sample(wo, u, 0);
              const auto own = single.sample(wo, u, 0);
              if (!of_group) {
                ASSERT_FALSE(own) << named.name;
                continue;
              }
              ASSERT_EQ(of_group->coherent & 1u, 1u);
              const Vec3 wi = of_group->wi;
              if ((of_group->coherent >> lane & 1u) != 0u) {
                ASSERT_TRUE(own) << named.name;
                ASSERT_EQ(own->wi.x, wi.x) << named.name;
                ASSERT_EQ(own->wi.y, wi.y);
                ASSERT_EQ(own->wi.z, wi.z);
                ASSERT_EQ(own->delta, of_group->delta);
                ASSERT_EQ(own->factor[0], of_group->factor[lane]) << named.name;
              } else {
                // It would have gone elsewhere.
                ASSERT_TRUE(!own || own->wi.x != wi.x || own->wi.y != wi.y || own->wi.z != wi.z)
                    << named.name;
              }
              ASSERT_EQ(Spectral<4>(group.value(wo, wi))[lane],
                        Spectral<1>(single.value(wo, wi))[0])
                  << named.name;
              ASSERT_EQ(Spectral<4>(group.pdf(wo, wi))[lane], Spectral<1>(single.pdf(wo, wi))[0]);
              const Evaluation<4> both = evaluate<4>(group, wo, wi);
              ASSERT_EQ(both.value[lane], Spectral<4>(group.value(wo, wi))[lane]) << named.name;
              ASSERT_EQ(both.pdf[lane], Spectral<4>(group.pdf(wo, wi))[lane]) << named.name;
            }
          });
        }
      });
    }
  }
}

template <class Bound>
void expect_sound(const Bound& kernel, Vec3 wo, Vec3 wi, const KernelNumbers& u) {
  const auto sound = [](float x) { return std::isfinite(x) && x >= 0.0f; };
  ASSERT_TRUE(sound(kernel.albedo(wo)[0]));
  for (int turn = 0; turn < 2; ++turn) {
    ASSERT_TRUE(sound(kernel.value(wo, wi)[0])) << kernel.value(wo, wi)[0];
    ASSERT_TRUE(sound(kernel.pdf(wo, wi)[0])) << kernel.pdf(wo, wi)[0];
    const auto draw = kernel.sample(wo, u, 0);
    if (!draw) return;
    ASSERT_TRUE(sound(draw->factor[0]));
    ASSERT_NEAR(length(draw->wi), 1.0f, 1e-5f);
    wi = draw->wi;
  }
}

// A million in all, over extremes of angle, roughness and index.
TEST(AllKernels, AreSoundEverywhere) {
  constexpr float kAlphas[]{0.0f, 1e-6f, 1e-4f, 2e-4f, 0.01f, 0.3f, 1.0f};
  constexpr float kIndices[]{1.0001f, 1.00001f, 1.3f, 4.0f, 0.25f, 0.9999f, 1.0f};
  const auto table = test::glossy_blob().kernel();
  const auto toward = [](const Uniform4& u) {
    // Half of them grazing, down to 1e-7.
    const float z = u[0] < 0.5f ? std::pow(10.0f, -14.0f * u[0]) : 2.0f * u[0] - 1.0f;
    return direction_from_z(std::clamp(z, 1e-7f, 1.0f), u[1]);
  };
  for (std::uint32_t i = 0; i < 170'000; ++i) {
    const auto a = test::numbers(2 * i, 41), b = test::numbers(2 * i + 1, 41);
    const Vec3 wo = toward(a);
    Vec3 wi = toward({a[2], a[3], 0.0f, 0.0f});
    if (b[3] < 0.25f) wi = {-wo.x, -wo.y, wo.z};
    if (b[3] > 0.5f) wi.z = -wi.z;
    if (b[3] > 0.95f) wi = -wo;
    const Roughness roughness = rough(kAlphas[i % 7], kAlphas[i / 7 % 7]);
    const float index = kIndices[i / 49 % 7];
    const KernelNumbers u{b[0], b[1], b[2]};
    const Shading<1> s{.wavelengths = 550.0f, .index_to = index};
    SCOPED_TRACE(i);
    expect_sound(Conductor{Spectrum(index), Spectrum(b[0]), roughness}.bind(s), wo, wi, u);
    expect_sound(Dielectric{roughness}.bind(s), wo, wi, u);
    if (i % 8 == 0) {
      const ThinFilm film({{Spectrum(1.38f), Spectrum(0.0f), 100.0},
                           {Spectrum(4.0f * b[1] + 0.01f), Spectrum(b[0]), 50.0}});
      expect_sound(Dielectric{roughness, film}.bind(s), wo, wi, u);
      expect_sound(Conductor{Spectrum(index), Spectrum(b[0]), roughness, film}.bind(s), wo, wi, u);
    }
    // Made with a table of many stacks.
    if (i % 500 == 0) {
      const ThinFilm film({{Spectrum(4.0f * b[1] + 0.01f), Spectrum(b[0]), 50.0}});
      expect_sound(
          Glazing({SheetPane{Spectrum(index), Spectrum(b[2]), film, {}}, FilmPane{film}}).bind(s),
          wo, wi, u);
    }
    expect_sound(CoatedDiffuse(Spectrum(index), roughness, Colour(Spectrum(1.0f))).bind(s), wo, wi,
                 u);
    expect_sound(
        Principled(Colour(Spectrum(1.0f)), Scalar(b[0]), Scalar(std::sqrt(kAlphas[i % 7])),
                   Spectrum(index), {Scalar(b[1]), Scalar(std::sqrt(kAlphas[i / 7 % 7])), 1.5f})
            .bind(s),
        wo, wi, u);
    expect_sound(
        Principled(Colour(Spectrum(1.0f)), Scalar(b[0]), Scalar(std::sqrt(kAlphas[i % 7])),
                   Spectrum(index), {Scalar(b[1]), Scalar(0.3f), 1.5f},
                   {.reflectance = Principled::Reflectance{Scalar(b[2]), Colour(Spectrum(a[0]))},
                    .brush = Principled::Brush{Scalar(std::sqrt(kAlphas[i / 7 % 7])), Scalar(a[1])},
                    .sheen = Principled::Fuzz{Colour(Spectrum(a[2])), Scalar(a[3])}})
            .bind(s),
        wo, wi, u);
    expect_sound(ThinPane(Spectrum(index), Spectrum(b[1])).bind(s), wo, wi, u);
    expect_sound(Phong{Colour(Spectrum(1.0f)), 1e6f * b[1] * b[1] * b[1]}.bind(s), wo, wi, u);
    expect_sound(table.bind(s), wo, wi, u);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace nocturne

// Microfacets of either distribution. docs/decisions/0014-importers.md says why there are two.
#pragma once

#include "kernels/beckmann.h"
#include "kernels/ggx.h"

namespace nocturne {

enum class FacetDistribution { kGgx, kBeckmann };

struct Facets {
  /// In [1e-4, 1].
  float alpha_u, alpha_v;
  FacetDistribution distribution = FacetDistribution::kGgx;

  Vec3 sample_visible(Vec3 wo, float u, float v) const {
    return with([&](const auto& d) { return d.sample_visible(wo, u, v); });
  }
  float visible(Vec3 wo, Vec3 h) const {
    return with([&](const auto& d) { return d.visible(wo, h); });
  }
  float reflection_pdf(Vec3 wo, Vec3 h) const {
    return with([&](const auto& d) { return d.reflection_pdf(wo, h); });
  }
  float reflection_weight(Vec3 wo, Vec3 wi) const {
    return with([&](const auto& d) { return d.reflection_weight(wo, wi); });
  }
  float transmission_weight(Vec3 wo, Vec3 wi) const {
    return with([&](const auto& d) { return d.transmission_weight(wo, wi); });
  }

 private:
  template <class F>
  auto with(const F& f) const -> decltype(f(Ggx{})) {
    return distribution == FacetDistribution::kGgx ? f(Ggx{alpha_u, alpha_v})
                                                   : f(Beckmann{alpha_u, alpha_v});
  }
};

}  // namespace nocturne

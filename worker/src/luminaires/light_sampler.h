// All techniques of next-event estimation at a vertex, as one density: area luminaires,
// environment, distant discs, important shapes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "luminaires/area_light_sampler.h"
#include "luminaires/distant_disc.h"
#include "luminaires/environment.h"
#include "luminaires/learned_light.h"
#include "luminaires/light_sampling_context.h"
#include "luminaires/visible_sky.h"

namespace nocturne {

/// Relative to each other, not negative. The others get the share of an empty group.
struct LightWeights {
  float luminaires, environment, important;
};

class LightSampler {
 public:
  /// Distant discs share the environment's weight, by the irradiance that each gives to the
  /// receiver as it is turned. Throws std::invalid_argument where a weight is negative or not
  /// finite.
  LightSampler(Elements luminaires, std::optional<Environment> environment,
               std::vector<DistantDisc> discs, Elements important_shapes,
               const LightWeights& weights);

  /// Nothing to point at, or no weight on it.
  bool empty() const { return !(luminaires_share_ + sky_share_ + important_share_ > 0.0f); }

  /// Whether `sample` may draw directions to important shapes.
  bool points_at_important() const { return important_share_ > 0.0f; }

  /// A unit direction from there; three uniform numbers. Empty where the drawn technique gives
  /// none. Its density is that of the element that it was drawn towards, which is zero where it was
  /// not drawn towards one.
  std::optional<DrawnDirection> sample(const LightSamplingContext& from, float choice, float u1,
                                       float u2) const;

  /// Where in the environment a direction is, for those who know.
  using SkyTexel = std::optional<Environment::Place>;

  /// Density of `sample`, 1/sr; finite, not negative.
  float pdf(const LightSamplingContext& from, Vec3 direction, const SkyTexel& place = {}) const;
  /// The same of a direction that `sample` gave. Rounding moves it off a lamp that is drawn at its
  /// rim: where the ray still meets the lamp, the density of all others alone would be smaller by
  /// the lamp's size, and its light as much too bright.
  float pdf(const LightSamplingContext& from, const DrawnDirection& drawn,
            const SkyTexel& place = {}) const {
    return std::max(drawn.pdf, pdf(from, drawn.direction, place));
  }

  /// A direction drawn towards light, and the emitter that may be seen there.
  struct LightSample {
    Vec3 direction;
    /// Of the direction, as `pdf` has it.
    float pdf;
    /// To the nearest element of a luminaire, m; infinite: the sky.
    float distance;
    /// Of that element, up to where a ray must be free, m; its luminaire and the unit normal there.
    float free_distance;
    std::uint32_t luminaire;
    Vec3 normal;
    /// Where it was drawn from the environment.
    std::optional<Environment::Drawn> environment;
  };
  /// Of the same numbers as sample_light; prefetches the data that it will look up.
  std::optional<Environment::PartialSample> begin_light(const LightSamplingContext& from,
                                                        float choice, float u1, float u2) const;
  /// From where its ray starts. False where the drawn technique gives no direction. Where nothing
  /// was learned.
  bool sample_light(const LightSamplingContext& from, float choice, float u1, float u2,
                    const std::optional<Environment::PartialSample>& begun,
                    LightSample& light) const;

  /// Half of the directions are drawn from the learned cones, where a context has a cell of them.
  void set_learned(LearnedLight learned) { learned_ = std::move(learned); }
  const LearnedLight& learned() const { return learned_; }

  /// VisibleSky::kPart of the directions to the environment are drawn from it, where a context has
  /// a cell.
  void set_visible_sky(VisibleSky sky) { visible_sky_ = std::move(sky); }
  const VisibleSky& visible_sky() const { return visible_sky_; }

  const std::optional<Environment>& environment() const { return environment_; }
  const std::vector<DistantDisc>& discs() const { return discs_; }
  /// Towards elements of luminaires alone.
  const AreaLightSampler& luminaires() const { return luminaires_; }
  /// Towards important shapes alone.
  const AreaLightSampler& important() const { return important_; }

 private:
  // Also report the sample drawn from the environment, if there is one.
  using FromEnvironment = std::optional<Environment::Drawn>;
  std::optional<DrawnDirection> sample(const LightSamplingContext& from, float choice, float u1,
                                       float u2, FromEnvironment& drawn) const;
  std::optional<DrawnDirection> sample_declared(const LightSamplingContext& from, float choice,
                                                float u1, float u2, FromEnvironment& drawn) const;
  std::optional<Vec3> sample_sky(const LightSamplingContext& from, float choice, float u1, float u2,
                                 FromEnvironment& drawn) const;
  std::optional<Vec3> finished(const LightSamplingContext& from,
                               const Environment::PartialSample& begun,
                               FromEnvironment& drawn) const;
  // `drawn` where it is known to be that direction.
  float sky_pdf(const LightSamplingContext& from, Vec3 direction, const SkyTexel& place,
                const FromEnvironment& drawn = {}) const;
  float declared_pdf(const LightSamplingContext& from, Vec3 direction, const SkyTexel& place) const;
  float environment_irradiance() const;
  // Part of the directions to the environment that is drawn from the visible sky.
  static float known_sky(const LightSamplingContext& from) {
    return from.visible_sky == VisibleSky::kNone ? 0.0f : VisibleSky::kPart;
  }
  // And that of discs.
  float sky_irradiance(const LightSamplingContext& from) const;

  LightWeights weights_;  // 0 where there is nothing
  AreaLightSampler luminaires_, important_;
  LearnedLight learned_;
  VisibleSky visible_sky_;
  std::optional<Environment> environment_;
  std::vector<DistantDisc> discs_;
  float luminaires_share_ = 0.0f, sky_share_ = 0.0f, important_share_ = 0.0f;  // sum 1, or all 0
};

}  // namespace nocturne

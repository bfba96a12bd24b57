#include "luminaires/light_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "math/constants.h"

namespace nocturne {
namespace {

/// Part of the directions that is drawn from the learned cones.
constexpr float kLearned = 0.5f;

// A number that fell into [start, start + width), stretched to [0, 1).
float stretched(float u, float start, float width) {
  return std::clamp((u - start) / width, 0.0f, kOneMinusEpsilon);
}

}  // namespace

LightSampler::LightSampler(Elements luminaires, std::optional<Environment> environment,
                           std::vector<DistantDisc> discs, Elements important_shapes,
                           const LightWeights& weights)
    : weights_(weights),
      luminaires_(std::move(luminaires)),
      important_(std::move(important_shapes), LightTree::Choice::kWeight),
      environment_(std::move(environment)),
      discs_(std::move(discs)) {
  for (const float w : {weights.luminaires, weights.environment, weights.important}) {
    if (!(w >= 0.0f) || !std::isfinite(w)) {
      throw std::invalid_argument("a weight of directions towards light is negative");
    }
  }
  float sky = environment_irradiance();
  for (const DistantDisc& disc : discs_) sky += disc.irradiance({0, 0, 1}, true);
  if (luminaires_.empty()) weights_.luminaires = 0.0f;
  if (!(sky > 0.0f)) weights_.environment = 0.0f;
  if (important_.empty()) weights_.important = 0.0f;
  const float total = weights_.luminaires + weights_.environment + weights_.important;
  const float scale = total > 0.0f ? total : 1.0f;
  luminaires_share_ = weights_.luminaires / scale;
  sky_share_ = weights_.environment / scale;
  important_share_ = weights_.important / scale;
}

std::optional<DrawnDirection> LightSampler::sample(const LightSamplingContext& from, float choice,
                                                   float u1, float u2) const {
  FromEnvironment drawn;
  return sample(from, choice, u1, u2, drawn);
}

std::optional<DrawnDirection> LightSampler::sample(const LightSamplingContext& from, float choice,
                                                   float u1, float u2,
                                                   FromEnvironment& drawn) const {
  if (from.learned == LearnedLight::kNone) return sample_declared(from, choice, u1, u2, drawn);
  if (choice >= kLearned) {
    auto declared =
        sample_declared(from, stretched(choice, kLearned, 1.0f - kLearned), u1, u2, drawn);
    if (declared) declared->pdf *= 1.0f - kLearned;
    return declared;
  }
  const Vec3 direction = learned_.sample(from.learned, stretched(choice, 0.0f, kLearned), u1, u2);
  if (!from.sees(direction)) return std::nullopt;
  return DrawnDirection{direction, 0.0f};
}

float LightSampler::pdf(const LightSamplingContext& from, Vec3 direction,
                        const SkyTexel& place) const {
  const float declared = declared_pdf(from, direction, place);
  if (from.learned == LearnedLight::kNone) return declared;
  const float learned = from.sees(direction) ? learned_.pdf(from.learned, direction) : 0.0f;
  return kLearned * learned + (1.0f - kLearned) * declared;
}

std::optional<DrawnDirection> LightSampler::sample_declared(const LightSamplingContext& from,
                                                            float choice, float u1, float u2,
                                                            FromEnvironment& drawn) const {
  const auto towards = [&](const AreaLightSampler& elements, float part, float share) {
    auto found = elements.sample(from, part, u1, u2);
    if (found) found->pdf *= share;
    return found;
  };
  if (choice < luminaires_share_) {
    return towards(luminaires_, stretched(choice, 0.0f, luminaires_share_), luminaires_share_);
  }
  const float before_important = luminaires_share_ + sky_share_;
  if (sky_share_ > 0.0f && (choice < before_important || !(important_share_ > 0.0f))) {
    const auto found =
        sample_sky(from, stretched(choice, luminaires_share_, sky_share_), u1, u2, drawn);
    return found ? std::optional(DrawnDirection{*found, 0.0f}) : std::nullopt;
  }
  if (!(important_share_ > 0.0f)) return std::nullopt;
  return towards(important_, stretched(choice, before_important, important_share_),
                 important_share_);
}

float LightSampler::declared_pdf(const LightSamplingContext& from, Vec3 direction,
                                 const SkyTexel& place) const {
  float sum = 0.0f;
  if (luminaires_share_ > 0.0f) sum += luminaires_share_ * luminaires_.pdf(from, direction);
  if (sky_share_ > 0.0f) sum += sky_share_ * sky_pdf(from, direction, place);
  if (important_share_ > 0.0f) sum += important_share_ * important_.pdf(from, direction);
  return sum;
}

std::optional<Environment::PartialSample> LightSampler::begin_light(
    const LightSamplingContext& from, float choice, float u1, float u2) const {
  if (!environment_ || choice < luminaires_share_ || choice >= luminaires_share_ + sky_share_) {
    return std::nullopt;
  }
  const float around = environment_irradiance();
  const float left = stretched(choice, luminaires_share_, sky_share_) * sky_irradiance(from);
  if (!(left < around) || left < known_sky(from) * around) return std::nullopt;
  return environment_->begin(from, u1, u2);
}

bool LightSampler::sample_light(const LightSamplingContext& from, float choice, float u1, float u2,
                                const std::optional<Environment::PartialSample>& begun,
                                LightSample& light) const {
  light.pdf = 0.0f;
  light.distance = light.free_distance = std::numeric_limits<float>::infinity();
  light.luminaire = Emission::kNoLuminaire;
  light.environment.reset();
  const auto take = [&](const AreaLightSampler::Nearest& nearest) {
    light.pdf = luminaires_share_ * nearest.pdf;
    if (!(nearest.distance < std::numeric_limits<float>::infinity())) return;
    light.distance = nearest.distance;
    light.normal = nearest.point.normal;
    const float cosine = std::max(1e-3f, std::fabs(dot(light.normal, light.direction)));
    light.free_distance = std::max(0.0f, nearest.distance - nearest.point.clearance / cosine);
    light.luminaire = luminaires_.elements().luminaire(nearest.element);
  };
  if (choice < luminaires_share_) {
    const float stretched_choice = stretched(choice, 0.0f, luminaires_share_);
    const auto drawn = luminaires_.draw(from, stretched_choice, u1, u2);
    if (!drawn) return false;
    light.direction = drawn->direction;
    take(drawn->nearest);
  } else {
    if (begun) {
      const auto direction = finished(from, *begun, light.environment);
      if (!direction) return false;
      light.direction = *direction;
    } else {
      const auto drawn = sample(from, choice, u1, u2, light.environment);
      if (!drawn) return false;
      light.direction = drawn->direction;
    }
    if (luminaires_share_ > 0.0f) {
      take(luminaires_.nearest(from, light.direction));
    }
  }
  if (sky_share_ > 0.0f) {
    light.pdf += sky_share_ * sky_pdf(from, light.direction, {}, light.environment);
  }
  if (important_share_ > 0.0f)
    light.pdf += important_share_ * important_.pdf(from, light.direction);
  // Drawn at a rim and rounded off it.
  return light.pdf > 0.0f;
}

float LightSampler::environment_irradiance() const {
  return environment_ ? kPi * static_cast<float>(environment_->mean_radiance()) : 0.0f;
}

float LightSampler::sky_irradiance(const LightSamplingContext& from) const {
  float total = environment_irradiance();
  for (const DistantDisc& disc : discs_) total += disc.irradiance(from.normal, from.both_sides);
  return total;
}

std::optional<Vec3> LightSampler::finished(const LightSamplingContext& from,
                                           const Environment::PartialSample& begun,
                                           FromEnvironment& drawn) const {
  drawn = environment_->finish(from, begun);
  return drawn ? std::optional(drawn->direction) : std::nullopt;
}

std::optional<Vec3> LightSampler::sample_sky(const LightSamplingContext& from, float choice,
                                             float u1, float u2, FromEnvironment& drawn) const {
  const float around = environment_irradiance(), total = sky_irradiance(from);
  if (!(total > 0.0f)) return std::nullopt;
  float left = choice * total;
  const float known = known_sky(from) * around;
  if (left < known) {
    const Vec3 direction = visible_sky_.sample(from.visible_sky, u1, u2);
    return from.sees(direction) ? std::optional(direction) : std::nullopt;
  }
  if (left < around) {
    drawn = environment_->draw(from, stretched(left, known, around - known), u1, u2);
    return drawn ? std::optional(drawn->direction) : std::nullopt;
  }
  left -= around;
  for (const DistantDisc& disc : discs_) {
    const float irradiance = disc.irradiance(from.normal, from.both_sides);
    if (left < irradiance) {
      const Vec3 direction = disc.sample(u1, u2);
      if (!from.sees(direction)) return std::nullopt;
      return direction;
    }
    left -= irradiance;
  }
  return std::nullopt;  // rounding, behind the last one
}

float LightSampler::sky_pdf(const LightSamplingContext& from, Vec3 direction, const SkyTexel& place,
                            const FromEnvironment& drawn) const {
  if (!from.sees(direction)) return 0.0f;
  const float around = environment_irradiance();
  float total = around;
  float sum = 0.0f;
  if (around > 0.0f) {
    sum = drawn   ? drawn->pdf
          : place ? environment_->pdf(from, direction, *place)
                  : environment_->pdf(from, direction);
    const float known = known_sky(from);
    if (known > 0.0f) {
      sum = (1.0f - known) * sum + known * visible_sky_.pdf(from.visible_sky, direction);
    }
    sum *= around;
  }
  for (const DistantDisc& disc : discs_) {
    const float irradiance = disc.irradiance(from.normal, from.both_sides);
    total += irradiance;
    if (irradiance > 0.0f) sum += irradiance * disc.pdf(direction);
  }
  return total > 0.0f ? sum / total : 0.0f;
}

}  // namespace nocturne

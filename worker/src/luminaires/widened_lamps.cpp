#include "luminaires/widened_lamps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/functions.h"

namespace nocturne {
namespace {

/// Mean over some visible wavelengths.
template <class Radiance>
float mean_of(const Radiance& radiance) {
  constexpr std::array kWavelengths{450.0f, 530.0f, 590.0f, 650.0f};
  float sum = 0.0f;
  for (const float each : kWavelengths) sum += radiance(Spectral<1>(each))[0];
  return sum / static_cast<float>(kWavelengths.size());
}

}  // namespace

WidenedLamps::WidenedLamps(const LightDirections& lights, std::span<const Luminaire> luminaires,
                           float least) {
  for (std::uint32_t i = 0; i < lights.discs().size(); ++i) {
    const DistantDisc& disc = lights.discs()[i];
    const float tangent = disc.tan_half_angle();
    const float solid_angle = kTwoPi * (1.0f - 1.0f / std::sqrt(1.0f + tangent * tangent));
    const float radiance = mean_of(
        [&](const Spectral<1>& wavelength) { return disc.radiance(disc.direction(), wavelength); });
    if (radiance < least) continue;
    discs_.push_back({i, std::min(1.0f, solid_angle / kCone)});
    brightest_ = std::max(brightest_, radiance);
  }
  if (lights.environment()) add_sky(*lights.environment(), least);
  const Elements& all = lights.luminaires().elements();
  std::vector<std::size_t> bright;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool shines = all.bounds(i).weight > 0.0;
    if (shines && luminaires[all.luminaire(i)].emission().radiance >= least) bright.push_back(i);
  }
  const std::size_t step = (bright.size() + kMostElements - 1) / kMostElements;
  for (std::size_t k = 0; k < bright.size(); k += std::max<std::size_t>(1, step)) {
    const ElementBounds& bounds = all.bounds(bright[k]);
    const std::uint32_t luminaire = all.luminaire(bright[k]);
    const std::size_t stands_for = std::min(step, bright.size() - k);
    elements_.push_back({0.5f * (bounds.low + bounds.high),
                         static_cast<float>(bounds.weight) * static_cast<float>(stands_for),
                         bounds.axis, bounds.cosine_power, bounds.cos_spread < 0.0f,
                         bounds.two_sided, luminaire, luminaires[luminaire].emission().radiance});
    brightest_ = std::max(brightest_, elements_.back().radiance);
  }
}

void WidenedLamps::add_sky(const Environment& environment, float least) {
  const LightSamplingContext from{.position = {}, .normal = {0, 0, 1}, .both_sides = true};
  // By the golden ratio, as evenly as a grid in all directions.
  constexpr float kGolden = 0.618034f;
  for (int i = 0; i < kSkyDraws; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / kSkyDraws,
                turn = kGolden * static_cast<float>(i);
    const auto drawn = environment.draw(from, u, u, turn - std::floor(turn));
    if (!drawn || !(drawn->pdf > 0.0f)) continue;
    const float radiance = mean_of(
        [&](const Spectral<1>& wavelength) { return environment.radiance(*drawn, wavelength); });
    if (radiance < least) continue;
    const float part = 1.0f / (drawn->pdf * kCone * kSkyDraws);
    sky_.push_back({drawn->direction, radiance * part});
    brightest_ = std::max(brightest_, radiance);
  }
}

float WidenedLamps::of(const Element& lamp, Vec3 origin, Vec3 direction, float distance,
                       std::uint32_t met) {
  const Vec3 there = lamp.place - origin;
  const float squared = dot(there, there), along = dot(there, direction);
  if (!(along > 0.0f) || along * along < kCosine * kCosine * squared) return 0.0f;
  if (met != lamp.luminaire && distance < along) return 0.0f;
  float intensity = lamp.intensity;
  if (!lamp.to_all_sides) {
    float cosine = -dot(lamp.axis, there) / std::sqrt(squared);
    if (lamp.two_sided) cosine = std::fabs(cosine);
    if (!(cosine > 0.0f)) return 0.0f;
    intensity *= math::pow(cosine, lamp.cosine_power + 1.0f);
  }
  // From close by the lamp fills the cone.
  return std::min(lamp.radiance, intensity / (squared * kCone));
}

}  // namespace nocturne

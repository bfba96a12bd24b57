#include "luminaires/widened_lamps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/functions.h"
#include "sampling/golden_ratio.h"

namespace nocturne {
namespace {

/// So many times the mean of the sky, and more, is a lamp in it.
constexpr float kSun = 10.0f;

/// Mean over some visible wavelengths.
template <class Radiance>
float mean_of(const Radiance& radiance) {
  constexpr std::array kWavelengths{450.0f, 530.0f, 590.0f, 650.0f};
  float sum = 0.0f;
  for (const float each : kWavelengths) sum += radiance(Spectral<1>(each))[0];
  return sum / static_cast<float>(kWavelengths.size());
}

}  // namespace

WidenedLamps::WidenedLamps(const LightSampler& lights, std::span<const Luminaire> luminaires,
                           float least) {
  for (const DistantDisc& disc : lights.discs()) {
    const float radiance = mean_of(
        [&](const Spectral<1>& wavelength) { return disc.radiance(disc.direction(), wavelength); });
    if (radiance < least) continue;
    // One over the disc's solid angle.
    const float density = disc.pdf(disc.direction());
    discs_.push_back(
        {disc.direction(), radiance, std::min(1.0f, 1.0f / (density * kCone)), disc.hidden_from});
  }
  if (lights.environment()) add_sky(*lights.environment(), least);
  add_elements(lights.luminaires().elements(), luminaires, least);
}

void WidenedLamps::add_sky(const Environment& environment, float least) {
  for (int i = 0; i < kSkyDraws; ++i) {
    const auto step = static_cast<float>(i);
    const auto drawn =
        environment.draw_all_around((step + 0.5f) / kSkyDraws, by_golden_ratio(step));
    if (!drawn || !(drawn->pdf > 0.0f)) continue;
    const float radiance = mean_of(
        [&](const Spectral<1>& wavelength) { return environment.radiance(*drawn, wavelength); });
    if (radiance < std::max(least, kSun * static_cast<float>(environment.mean_radiance())))
      continue;
    sky_.push_back({drawn->direction, radiance, 1.0f / (drawn->pdf * kCone * kSkyDraws),
                    environment.hidden_from});
  }
}

void WidenedLamps::add_elements(const Elements& all, std::span<const Luminaire> luminaires,
                                float least) {
  std::vector<std::size_t> bright;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool shines = all.bounds(i).weight > 0.0;
    if (shines && luminaires[all.luminaire(i)].emission().radiance >= least) bright.push_back(i);
  }
  if (bright.empty()) return;
  const std::size_t step = (bright.size() + kPoints - 1) / kPoints;
  // A strip is longer than the cone is wide: it has points all along it.
  const std::size_t points = std::max<std::size_t>(1, kPoints / bright.size());
  for (std::size_t k = 0; k < bright.size(); k += step) {
    const ElementBounds& bounds = all.bounds(bright[k]);
    const Luminaire& luminaire = luminaires[all.luminaire(bright[k])];
    const float stands_for = static_cast<float>(std::min(step, bright.size() - k));
    const Vec3 middle = bounds.middle(), extent = bounds.high - bounds.low;
    const bool ball = bounds.cos_spread < 0.0f;
    // From so far off that a flat element is drawn evenly over its area.
    const float far = 100.0f * length(extent);
    const LightSamplingContext from{
        .position = middle + far * bounds.axis, .normal = -bounds.axis, .both_sides = true};
    const std::size_t count = ball ? 1 : points;
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = static_cast<float>(i);
      const auto drawn =
          ball ? std::nullopt
               : all.draw(bright[k], from, (number + 0.5f) / static_cast<float>(count),
                          by_golden_ratio(number));
      const bool on_it = drawn && std::isfinite(drawn->distance);
      const Vec3 place = on_it ? from.position + drawn->distance * drawn->direction : middle;
      elements_.push_back(
          {.place = place,
           .radius = ball ? 0.5f * std::max({extent.x, extent.y, extent.z}) : 0.0f,
           .intensity = static_cast<float>(bounds.weight) * stands_for / static_cast<float>(count),
           .axis = bounds.axis,
           .cosine_power = bounds.cosine_power,
           .to_all_sides = ball,
           .two_sided = bounds.two_sided,
           .radiance = luminaire.emission().radiance,
           .hidden_from = luminaire.hidden_from});
    }
  }
}

float WidenedLamps::part_of_cone(const Element& lamp, Vec3 there, float squared) {
  float intensity = lamp.intensity;
  if (!lamp.to_all_sides) {
    float cosine = -dot(lamp.axis, there) / std::sqrt(squared);
    if (lamp.two_sided) cosine = std::fabs(cosine);
    if (!(cosine > 0.0f)) return 0.0f;
    intensity *= math::pow(cosine, lamp.cosine_power + 1.0f);
  }
  // From close by the lamp fills the cone.
  return std::min(1.0f, intensity / (squared * kCone * lamp.radiance));
}

}  // namespace nocturne

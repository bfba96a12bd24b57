#include "scene/load_daylight.h"

#include <cmath>
#include <numeric>

#include "scene/load_context.h"

namespace nocturne {
namespace {

// Hours of a leap year.
constexpr int kMaxSuns = 8784;

void load_patches(const v1::DaylightCoefficients& message, DaylightCoefficients& made) {
  const std::uint32_t patches = made.patches.count();
  made.places.assign(patches, DaylightCoefficients::kNotCounted);
  for (const std::uint32_t patch : message.patches()) {
    require(patch < patches && made.places[patch] == DaylightCoefficients::kNotCounted,
            "a patch of the sky that is not there, or is there twice");
    made.places[patch] = made.counted++;
  }
  if (made.counted > 0) return;
  std::iota(made.places.begin(), made.places.end(), 0u);
  made.counted = patches;
}

void load_suns(const v1::DaylightCoefficients& message, DaylightCoefficients& made) {
  require(message.suns_size() <= kMaxSuns, "more suns than a year has hours");
  for (const auto& sun : message.suns()) {
    const Vec3 towards = vector(sun, "a sun's direction");
    require(std::fabs(length(towards) - 1.0f) < 1e-3f, "a sun's direction that has not length 1");
    made.suns.push_back(normalized(towards));
  }
}

}  // namespace

std::optional<DaylightCoefficients> load_daylight(const v1::CompiledScene& message, Scene& scene) {
  if (!message.has_daylight()) return std::nullopt;
  require(scene.sensor.aims() && scene.options.direction == Direction::kAdjoint &&
              scene.lights.environment() && !scene.polarised,
          "daylight coefficients of anything but meters under a sky");
  scene.options.sharing = 1;
  // Photons that fly towards lights tell what they meet.
  scene.shadow_rays_suffice = false;
  return checked([&] {
    const auto& daylight = message.daylight();
    DaylightCoefficients made{SkyPatches(daylight.divisions(),
                                         vector(daylight.up(), "the sky's up"),
                                         vector(daylight.north(), "the sky's north"))};
    load_patches(daylight, made);
    made.reflected_alone = daylight.reflected_alone();
    load_suns(daylight, made);
    return std::optional(std::move(made));
  });
}

}  // namespace nocturne

#include "tracer/pilot/guide_trial.h"

#include <algorithm>
#include <limits>

#include "tracer/pilot/compare_methods.h"
#include "tracer/pilot/rare_light.h"
#include "tracer/pilot/rounds.h"

namespace nocturne {
namespace {

/// How many times more often photons must find gathered light with a guide, or how many times less
/// their variance must be; and how many samples must have found it.
constexpr double kGuidePays = 4.0, kEnoughFinds = 16.0;

struct GuideTrial {
  bool pays = false;
  double differs_by = 0.0;
};

/// `kind`: from the sensor, without a guide.
GuideTrial try_guide(Scene& scene, Trials& trials, const PhotonKind& kind, Film film,
                     std::uint32_t samples, double mean) {
  PhotonKind with_guide = kind;
  with_guide.guided = true;
  scene.options.gathered = TracingOptions::Gathered::kMet;
  scene.options.least_radiance = std::numeric_limits<float>::min();  // no media that glow
  const PilotImages before = trials.images(kind, film, whole(film, samples)),
                    after = trials.images(with_guide, film, whole(film, samples));
  scene.options.gathered = trials.given().gathered;
  scene.options.least_radiance = trials.given().least_radiance;
  const auto means = means_of_images(before), means_guided = means_of_images(after);
  const MeanLight plain = mean_and_error(before), guided = mean_and_error(after);
  GuideTrial trial;
  if (is_more(means, means_guided, kFault)) {
    trial.differs_by = guided.mean / plain.mean - 1.0;
    return trial;
  }
  const double often = finds_of(after) / finds_of(before), certain = plain.error / guided.error;
  const bool better =
      is_more(means_guided, means) || often > kGuidePays || certain * certain > kGuidePays;
  trial.pays = better && guided.mean > kCounts * mean && finds_of(after) > kEnoughFinds;
  return trial;
}

}  // namespace

double choose_guide(Scene& scene, Trials& trials, std::vector<PilotMethod>& methods, Film film,
                    std::uint32_t samples, double mean) {
  const PilotMethod plainest = methods.front();
  const auto& any = methods.back().sensor ? methods.back() : plainest;
  if (!any.sensor) return 0.0;
  PhotonKind plain = *any.sensor;
  plain.guided = false;
  const auto most = std::min(kMostSamplesOfARound, samples);
  const GuideTrial trial = try_guide(scene, trials, plain, film, most, mean);
  std::erase_if(methods, [&](const PilotMethod& each) {
    if (!each.sensor || !trial.pays) return each.sensor && each.sensor->guided;
    return each.sensor->from == plain.from && !each.sensor->guided && each != plainest;
  });
  return trial.differs_by;
}

}  // namespace nocturne

#include "tracer/pilot/pilot.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "math/functions.h"
#include "tracer/pilot/compare_methods.h"
#include "tracer/pilot/rare_light.h"
#include "tracer/pilot/trials.h"
#include "tracer/sharing/sharing_trial.h"

namespace nocturne {
namespace {

/// Part of the render's rays that a pilot takes including those it learned from, and the most of
/// them; and part of a small render's, between the least that is informative and a matter of a
/// second.
constexpr double kPart = 0.024, kMostRays = 12e6;
constexpr double kPartOfSmall = 0.2, kLeastRays = 0.25e6, kEnoughRays = 2e6;
/// Samples of a pixel in the first round, and in the last; each has four times as many as the one
/// before. By few samples, those from the sensor had 2 to 50 times the error that they have in a
/// render, where they fill all dimensions evenly, and those from luminaires 1 to 3 times.
constexpr std::uint32_t kSamples = 16, kMostSamples = 256, kMoreSamples = 4;
/// Of all rounds, where half the methods go on after each: that of the first times this, about.
constexpr double kRounds = 10.0;
/// How many times more often photons must find gathered light with a guide, or how many times less
/// their variance must be; and as many finds as tell.
constexpr double kGuidePays = 4.0, kEnoughFinds = 16.0;
/// A ratio of photons from luminaires may be so many times worse than the best, to have more of
/// them: in the larger pixels of a small film those from the sensor have more error than in the
/// render, and the best ratio came out 1.5 times too low in 40 scenes (docs/decisions/0130).
constexpr double kAboutAsGood = 1.1;
/// Part of its samples with which a pilot tries sharing.
constexpr double kForSharing = 1.0 / 3;

class Pilot {
 public:
  Pilot(Scene& scene, const PilotRequest& request)
      : scene_(scene), request_(request), trials_(scene, request.film, request.threads) {}

  PilotResult run() {
    TracingOptions given = trials_.given();
    if (request_.direction && given.direction != Direction::kForward && !scene_.has_mirrors) {
      given.direction = Direction::kAdjoint;
    }
    methods_ = methods_of({request_.direction, request_.aim, request_.guide}, given);
    measure_samples();
    best_.method = plain_.method = methods_.front();
    choose_film();
    if (request_.guide) choose_guide();
    if (methods_.size() > 1) choose_method();
    if (request_.sharing && best_.method.sensor) choose_sharing();
    choose();
    if (request_.parts && scene_.has_mirrors && best_.method.sensor) {
      PhotonKind alone = *best_.method.sensor;
      alone.sharing = 1;
      result_.unmet_parts = find_unmet_parts(scene_, trials_, alone, request_.film,
                                             request_.samples, budget_ / 2, mean_);
    }
    for (const auto& [kind, figures] : tried_) result_.tried.push_back(figures);
    result_.photons = trials_.photons();
    result_.rays = trials_.rays();
    return std::move(result_);
  }

 private:
  /// How many the pilot may take in all, by what a few of them take.
  void measure_samples() {
    const Film film = trials_.reduced(256.0);
    const PilotImages probe = trials_.images({}, film, whole(film, kSamples), 1);
    const double rays = std::max(1.0, rays_of(probe) / (pixels_of(film) * kSamples));
    mean_ = means_of_images(probe)[0];
    const double all = rays * pixels_of(request_.film) * request_.samples;
    const double of_small = std::clamp(kPartOfSmall * all, kLeastRays, kEnoughRays);
    const double part = std::max(kPart * all, of_small);
    budget_ = std::max(0.0, std::min(part, kMostRays) / rays - request_.lessons);
  }

  /// A small one, so that all rounds and the look at guides keep to the budget.
  void choose_film() {
    if (methods_.size() == 1) return;
    const double rounds = kRounds * kSamples * static_cast<double>(kinds_of(methods_).size());
    const double samples = rounds + (request_.guide ? 2.0 * kMostSamples : 0.0);
    small_film_ = trials_.reduced((1.0 - kForSharing) * budget_ / (Trials::kImages * samples));
  }

  /// A guide helps photons from the sensor to what mirrors and glass gather and no photon from a
  /// luminaire brings, and costs time everywhere else. That light alone decides: whether more of it
  /// is met, or it is found more often, or with less variance. Errors of a few images don't show
  /// what hardly any photon finds.
  void choose_guide() {
    const auto& any = methods_.back().sensor ? methods_.back() : methods_.front();
    if (!any.sensor) return;
    PhotonKind plain = *any.sensor, guided = plain;
    plain.guided = false;
    guided.guided = true;
    const auto range = whole(small_film_, std::min(kMostSamples, request_.samples));
    scene_.options.gathered = TracingOptions::Gathered::kMet;
    scene_.options.least_radiance = std::numeric_limits<float>::min();  // no media that glow
    const PilotImages before = trials_.images(plain, small_film_, range),
                      after = trials_.images(guided, small_film_, range);
    scene_.options.gathered = trials_.given().gathered;
    scene_.options.least_radiance = trials_.given().least_radiance;
    const auto means = means_of_images(before), means_guided = means_of_images(after);
    const auto [found, error] = mean_and_error(after);
    const double certain = mean_and_error(before).error / error,
                 often = finds_of(after) / finds_of(before);
    const bool loses = is_more(means, means_guided, kFault);
    const bool pays =
        !loses && found > kCounts * mean_ && finds_of(after) > kEnoughFinds &&
        (is_more(means_guided, means) || often > kGuidePays || certain * certain > kGuidePays);
    std::erase_if(methods_, [&](const PilotMethod& each) {
      return each.sensor && (pays ? each.sensor->from == plain.from && !each.sensor->guided &&
                                        each != methods_.front()
                                  : each.sensor->guided);
    });
    if (!loses) return;
    result_.fault = PilotResult::Fault::kGuided;
    result_.differs_by = found / mean_and_error(before).mean - 1.0;
  }

  /// Successive halving: in each round, half as many methods have four times the samples.
  void choose_method() {
    std::vector<PilotMethod> left = methods_;
    for (samples_ = kSamples;; samples_ *= kMoreSamples) {
      std::vector<MethodFigures> figures = compared(left);
      std::ranges::stable_sort(figures, is_better);
      best_ = figures.front();
      for (const MethodFigures& each : figures) {
        if (each.method == methods_.front()) plain_ = each, beside_plain_ = best_;
      }
      if (samples_ * kMoreSamples > std::min(kMostSamples, request_.samples)) break;
      figures.resize((figures.size() + 1) / 2);
      left.clear();
      for (const MethodFigures& each : figures) left.push_back(each.method);
    }
    const bool all_light = best_.method.sensor && !best_.method.luminaires;
    if (all_light && methods_.back().luminaires) look_for_rare_light();
  }

  /// Rare light hides in the noise of other light: it is looked for alone.
  void look_for_rare_light() {
    const PhotonKind sensor = *best_.method.sensor;
    const PilotMethod method = surest_from_luminaires(
        methods_, sensor,
        [&](const PhotonKind& kind) -> const PilotImages& { return images_[kind]; });
    const PilotImages& brought = small_images(*method.luminaires);
    PilotImages left = small_images(sensor);
    const double mean = best_.mean.mean;
    if (method.sensor) subtract(left, small_images(*method.sensor));
    result_.unmet = may_be_unmet(mean_and_error(brought), mean_and_error(left), mean);
    const double samples = pixels_of(request_.film) * request_.samples;
    const auto light = find_rare_light(scene_, trials_, *method.luminaires, sensor, small_film_,
                                       samples_, rare_radiance(mean_, samples));
    if (!light) return;
    result_.unmet = std::max(result_.unmet, may_be_missing(*light, mean));
    if (!must_be_brought(*light, mean)) return;
    result_.unmet = 0.0;
    std::vector<PilotMethod> bring_it;
    for (const PilotMethod& each : methods_) {
      if (each.luminaires == method.luminaires) bring_it.push_back(each);
    }
    best_ = std::ranges::min(compared(bring_it), is_better);
    finds_rare_light_ = true;
  }

  void choose_sharing() {
    const SharingTrial trial =
        try_sharing(trials_, request_.film, *best_.method.sensor, kForSharing * budget_);
    tried_.try_emplace(trial.alone.kind, trial.alone);
    tried_[trial.shared.kind] = trial.shared;
    if (small_film_.width == 0) {
      best_.sensor = trial.alone;
      plain_ = beside_plain_ = best_;
    }
    MethodFigures shared = best_;
    shared.method.sensor = trial.shared.kind;
    shared.sensor.relative_mse *= trial.shared.relative_mse / trial.alone.relative_mse;
    shared.sensor.cost *= trial.shared.cost / trial.alone.cost;
    if (shared.method.luminaires && !given_ratio()) {
      shared.ratio = best_forward_ratio(shared.sensor, shared.luminaires);
    }
    sharing_error_ = error_of_log_ratio(trial.alone.of_groups, trial.shared.of_groups);
    const double worth_it = kWorthIt * math::exp(sharing_error_);
    // Not a number where nothing has an error.
    if (!(best_.product() > worth_it * shared.product())) return;
    if (trial.differs_by != 0.0) {
      result_.fault = PilotResult::Fault::kShared;
      result_.differs_by = trial.differs_by;
    } else {
      gain_of_sharing_ = best_.product() / shared.product();
      best_ = shared;
    }
  }

  void choose() {
    const auto& [sensor, luminaires] = best_.method;
    const TracingOptions& given = trials_.given();
    const bool both = luminaires || !request_.direction;
    const double ratio = sensor && luminaires && !given_ratio()
                             ? best_forward_ratio(best_.sensor, best_.luminaires, kAboutAsGood)
                             : best_.ratio;
    result_.choice = {.direction = both ? given.direction : Direction::kAdjoint,
                      .sharing = sensor ? sensor->sharing : 1,
                      .aimed = luminaires ? luminaires->aimed
                               : both     ? given.aimed_emission
                                          : 0.0f,
                      .forward_ratio = luminaires ? ratio
                                       : both     ? given.forward_ratio
                                                  : 1.0,
                      .gain = 1.0,
                      .finds_more = plain_.misses_light || finds_rare_light_,
                      .guided = sensor && sensor->guided};
    if (!(plain_.product() > 0.0 && beside_plain_.product() > 0.0)) return;
    const GroupErrors plain = plain_.errors_of_groups(), best = beside_plain_.errors_of_groups();
    result_.choice.gain = plain_.product() / beside_plain_.product() * gain_of_sharing_;
    result_.choice.gain_error =
        math::hypot(error_of_log_ratio(plain, best), gain_of_sharing_ > 1.0 ? sharing_error_ : 0.0);
  }

  /// Of the small film, with as many samples as the round has.
  const PilotImages& small_images(const PhotonKind& kind) {
    PilotImages& images = images_[kind];
    if (images.samples < samples_) {
      const auto more = whole(small_film_, samples_, images.samples);
      extend(images, trials_.images(kind, small_film_, more));
    }
    return images;
  }

  std::vector<MethodFigures> compared(const std::vector<PilotMethod>& methods) {
    auto figures = figures_of_methods(
        methods, [&](const PhotonKind& kind) -> const PilotImages& { return small_images(kind); },
        given_ratio());
    for (const MethodFigures& each : figures) {
      if (each.method.sensor) tried_[each.sensor.kind] = each.sensor;
      if (each.method.luminaires) tried_[each.luminaires.kind] = each.luminaires;
    }
    return figures;
  }

  std::optional<double> given_ratio() const {
    return request_.ratio ? std::nullopt : std::optional(trials_.given().forward_ratio);
  }

  Scene& scene_;
  const PilotRequest request_;
  Trials trials_;
  std::vector<PilotMethod> methods_;
  std::map<PhotonKind, PilotImages> images_;
  std::map<PhotonKind, PilotFigures> tried_;
  /// Empty where there is nothing but sharing to choose.
  Film small_film_{0, 0};
  std::uint32_t samples_ = 0;
  /// The plainest method, and the best compared with it in the last round that it had part in.
  MethodFigures plain_, beside_plain_, best_;
  bool finds_rare_light_ = false;
  double gain_of_sharing_ = 1.0, sharing_error_ = 0.0;
  /// Samples in all; Y of the image, cd/m2.
  double budget_ = 0.0, mean_ = 0.0;
  PilotResult result_{};
};

}  // namespace

PilotResult run_pilot(Scene& scene, const PilotRequest& request) {
  return Pilot(scene, request).run();
}

}  // namespace nocturne

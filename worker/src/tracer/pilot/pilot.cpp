#include "tracer/pilot/pilot.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "math/functions.h"
#include "tracer/pilot/guide_trial.h"
#include "tracer/pilot/pilot_budget.h"
#include "tracer/pilot/rare_light.h"
#include "tracer/pilot/rounds.h"
#include "tracer/pilot/trials.h"
#include "tracer/sharing/sharing_trial.h"

namespace nocturne {
namespace {

class Pilot {
 public:
  Pilot(Scene& scene, const PilotRequest& request)
      : scene_(scene), request_(request), trials_(scene, request.film, request.threads) {
    if (!request.ratio) given_ratio_ = scene.options.forward_ratio;
  }

  PilotResult run() {
    const auto [budget, mean] = pilot_budget(trials_, request_);
    mean_ = mean;
    const OpenChoices open{request_.direction, request_.aim, request_.guide};
    const auto methods = methods_of(open, trials_.given(), scene_.has_mirrors);
    if (methods.size() > 1) compare(methods, budget);
    if (best_.method == PilotMethod{}) best_.method = plain_.method = methods.front();
    if (request_.sharing && best_.method.sensor) try_sharing(budget);
    choose();
    if (request_.parts && scene_.has_mirrors && best_.method.sensor) {
      result_.unmet_parts = find_unmet_parts(scene_, trials_, *best_.method.sensor, request_.film,
                                             request_.samples, budget / 2, mean_);
    }
    for (const auto& [kind, figures] : tried_) result_.tried.push_back(figures);
    result_.photons = trials_.photons();
    result_.rays = trials_.rays();
    return std::move(result_);
  }

 private:
  /// On a film so small that the trial of the guide and all rounds keep to the budget.
  void compare(std::vector<PilotMethod> methods, double budget) {
    const double rounds = kSamplesOfRounds * static_cast<double>(kinds_of(methods).size());
    const double samples = rounds + (request_.guide ? 2.0 * kMostSamplesOfARound : 0.0);
    const Film film = trials_.reduced((1.0 - kForSharing) * budget / (Trials::kImages * samples));
    if (request_.guide) {
      report(PilotResult::Fault::kGuided,
             choose_guide(scene_, trials_, methods, film, request_.samples, mean_));
    }
    if (methods.size() == 1) return;
    Rounds compared(trials_, film, request_.samples, given_ratio_);
    best_ = compared.best_of(methods);
    plain_ = compared.plainest();
    beside_plain_ = compared.best_beside_plainest();
    const bool all_light = best_.method.sensor && !best_.method.luminaires;
    if (all_light && methods.back().luminaires) look_for_rare_light(methods, compared, film);
    tried_ = compared.tried();
  }

  void look_for_rare_light(const std::vector<PilotMethod>& methods, Rounds& compared, Film film) {
    const double samples = pixels_of(request_.film) * request_.samples;
    const RareLightTrial trial =
        try_rare_light(scene_, trials_, methods, *best_.method.sensor, compared.images(), film,
                       compared.samples(), rare_radiance(mean_, samples), best_.mean.mean);
    result_.unmet = trial.unmet;
    finds_rare_light_ = !trial.bring_it.empty();
    if (finds_rare_light_) best_ = std::ranges::min(compared.compared(trial.bring_it), is_better);
  }

  void try_sharing(double budget) {
    const SharingTrial trial =
        nocturne::try_sharing(trials_, request_.film, *best_.method.sensor, kForSharing * budget);
    tried_.try_emplace(trial.alone.kind, trial.alone);
    tried_[trial.shared.kind] = trial.shared;
    if (best_.sensor.cost == 0.0) {  // there was nothing else to choose
      best_.sensor = trial.alone;
      plain_ = beside_plain_ = best_;
    }
    const MethodFigures shared = with_sharing(best_, trial, !given_ratio_);
    sharing_error_ = error_of_log_ratio(trial.alone.of_groups, trial.shared.of_groups);
    const double worth_it = kWorthIt * math::exp(sharing_error_);
    // Not a number where nothing has an error.
    if (!(best_.product() > worth_it * shared.product())) return;
    if (trial.differs_by != 0.0) return report(PilotResult::Fault::kShared, trial.differs_by);
    gain_of_sharing_ = best_.product() / shared.product();
    best_ = shared;
  }

  void choose() {
    const auto& [sensor, luminaires] = best_.method;
    PilotChoice& choice = result_.choice;
    choice = {.direction = Direction::kAdjoint,
              .sharing = sensor ? sensor->sharing : 1,
              .aimed = 0.0f,
              .forward_ratio = 1.0,
              .gain = 1.0,
              .finds_more = plain_.misses_light || finds_rare_light_,
              .guided = sensor && sensor->guided};
    if (luminaires || !request_.direction) {
      const TracingOptions& given = trials_.given();
      choice.direction = given.direction;
      choice.aimed = luminaires ? luminaires->aimed : given.aimed_emission;
      choice.forward_ratio = luminaires ? best_.ratio : given.forward_ratio;
    }
    if (sensor && luminaires && !given_ratio_) {
      choice.forward_ratio = best_forward_ratio(best_.sensor, best_.luminaires, kAboutAsGood);
    }
    if (!(plain_.product() > 0.0 && beside_plain_.product() > 0.0)) return;
    choice.gain = plain_.product() / beside_plain_.product() * gain_of_sharing_;
    choice.gain_error =
        math::hypot(error_of_log_ratio(plain_.errors_of_groups(), beside_plain_.errors_of_groups()),
                    gain_of_sharing_ > 1.0 ? sharing_error_ : 0.0);
  }

  void report(PilotResult::Fault fault, double differs_by) {
    if (differs_by == 0.0) return;
    result_.fault = fault;
    result_.differs_by = differs_by;
  }

  Scene& scene_;
  const PilotRequest request_;
  Trials trials_;
  /// Where it is not open.
  std::optional<double> given_ratio_;
  std::map<PhotonKind, PilotFigures> tried_;
  /// The plainest method, and the best that it was compared with.
  MethodFigures plain_, beside_plain_, best_;
  bool finds_rare_light_ = false;
  double gain_of_sharing_ = 1.0, sharing_error_ = 0.0;
  /// Y of the image, cd/m2.
  double mean_ = 0.0;
  PilotResult result_{};
};

}  // namespace

PilotResult run_pilot(Scene& scene, const PilotRequest& request) {
  return Pilot(scene, request).run();
}

}  // namespace nocturne

// The order of what a pilot asks, in one long file, as each choice goes on from the figures of
// those before: direction, guide, sharing. What the figures mean is decided in forward_pays and
// sharing_pays.
#include "tracer/pilot.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "math/functions.h"
#include "tracer/forward_pays.h"
#include "tracer/rare_light.h"
#include "tracer/sharing_pays.h"
#include "tracer/trials.h"

namespace nocturne {
namespace {

/// Samples of a pixel in each image.
constexpr std::uint32_t kSamples = 16;
/// The same for sharing, whose worth depends on how many samples are stratified together: as many
/// as leave so many squares of the film, in images that pixels alone can be judged by.
constexpr std::uint32_t kSharingImages = 2, kMaxSharingSamples = 64;
constexpr double kEnoughSquares = 16.0;
/// Edge of these squares, pixels: a film's few corners of much noise are one of many small ones,
/// and one of few large ones (docs/decisions/0115).
constexpr std::uint32_t kSquare = 8;
constexpr std::size_t kParts = 5;
/// Part of the render's samples that a pilot takes with its lessons, the most samples without
/// these, and the most rays.
constexpr double kPart = 0.024, kMaxSamples = 1.5e6, kMaxRays = 12e6;
/// A closer look at both directions, where a small film left that open, takes this part of it.
constexpr double kSecondLook = 6.0;
constexpr std::uint32_t kPatch = 4;  // edge of its squares, pixels
constexpr double kFewPatches = 8.0;
/// Then less is enough: the light in question comes in bright samples, of which few were met.
constexpr double kWorthItCloser = 1.1;
/// What is enough to tell directions apart is taken even if that is a larger part of a render,
/// as long as its rays are a matter of a second.
constexpr double kEnoughSamples = 50e3, kEnoughRays = 0.5e6;
/// Of an occlusion query between neighbours, and of a forward photon's ray with its connection to
/// the camera and its place on the film, in rays of adjoint photons: measured, docs/decisions/0115
/// and 0062.
constexpr double kQueryCost = 0.5, kForwardCost = 1.5;
/// Of a guided sample over that of one that is not: looking up and asking cells of learned light,
/// measured, docs/decisions/0104. Part of the direction's budget that comparing these takes.
constexpr double kGuideCost = 1.1, kGuidePart = 0.5;
/// Part of the forward photons that is aimed where as many as the options say are too many: what is
/// found elsewhere then weighs 1.4 times as much instead of 10 times (docs/decisions/0106).
constexpr float kFewAimed = 0.3f;

/// Of a mean; what found nothing is the least certain.
double relative_error(double mean, double error) {
  return mean > 0.0 ? error / mean : std::numeric_limits<double>::infinity();
}

class Pilot {
 public:
  Pilot(Scene& scene, const PilotRequest& request)
      : scene_(scene),
        request_(request),
        before_(scene.options),
        trials_(scene, request.film, request.threads),
        budget_(samples()) {
    scene_.options.guide = false;
  }
  ~Pilot() {
    scene_.options = before_;
    scene_.lights.set_hints(true);
  }
  Pilot(const Pilot&) = delete;
  Pilot& operator=(const Pilot&) = delete;

  PilotResult run() {
    result_.choice = {Direction::kAdjoint, 1, 0.0f, 1.0, 1.0, false};
    if (!request_.direction) {
      result_.choice.direction = before_.direction;
      result_.choice.aimed = before_.aimed_emission;
      result_.choice.forward_ratio = before_.forward_ratio;
    }
    if (request_.direction && forward_can_bring()) choose_direction();
    scene_.lights.set_hints(result_.choice.hinted);
    if (request_.guide && result_.choice.direction != Direction::kForward) choose_guide();
    if (request_.sharing && result_.choice.direction != Direction::kForward &&
        before_.estimator == Estimator::kTwoPhotons) {
      choose_sharing();
    }
    if (request_.parts && scene_.has_mirrors) look_for_unmet_parts();
    result_.photons = trials_.photons();
    result_.rays = trials_.rays();
    return result_;
  }

 private:
  /// Samples in all that the pilot may take.
  double samples() {
    // What a sample takes, by a few of them.
    const Film small = trials_.reduced(256.0);
    const PilotImages probe =
        trials_.images(Direction::kAdjoint, 1, small, whole(small, kSamples), 1);
    const double rays = std::max(1.0, rays_of(probe) / (pixels_of(small) * kSamples));
    mean_of_probe_ = mean_and_error(probe)[0];
    const double part = kPart * pixels_of(request_.film) * request_.samples;
    const double all = std::max(part, std::min(kEnoughSamples, kEnoughRays / rays));
    return std::min(std::clamp(all - request_.lessons, 0.0, kMaxSamples), kMaxRays / rays);
  }

  bool forward_can_bring() const {
    return before_.direction == Direction::kForward || scene_.has_mirrors;
  }

  void choose_direction() {
    std::vector<float> aims{before_.aimed_emission};
    for (const float fewer : {kFewAimed, 0.0f}) {
      if (request_.aim && fewer < aims.front()) aims.push_back(fewer);
    }
    const bool both = before_.direction == Direction::kBoth, hint = request_.hint && both;
    const auto ways = static_cast<double>((request_.guide ? 3 : 2) + (hint ? 1 : 0) + aims.size());
    const Film film = trials_.reduced(budget_ / 2 / (ways * Trials::kImages * kSamples));
    const auto square = whole(film, kSamples);
    const PilotImages plain = trials_.images(Direction::kAdjoint, 1, film, square);
    PilotImages led = plain;
    if (request_.guide) {
      scene_.options.guide = true;
      led = trials_.images(Direction::kAdjoint, 1, film, square);
    }
    const std::vector<double> first_look = shown_by({&plain}, {&led});
    // The better ones of these leave to forward photons what those bring.
    guided_first_ = request_.guide && guide_pays(adjoint_figures(plain, false, first_look),
                                                 adjoint_figures(led, true, first_look));
    scene_.options.guide = guided_first_;
    const PilotImages& all = guided_first_ ? led : plain;
    PilotImages rest, unhinted, left = all;
    if (both) {
      rest = trials_.images(Direction::kBoth, 1, film, square);
      if (hint) {
        scene_.lights.set_hints(false);
        unhinted = trials_.images(Direction::kBoth, 1, film, square);
        scene_.lights.set_hints(true);
      }
      subtract(left, rest);
    }
    std::vector<PilotImages> forward;
    for (const float aimed : aims) {
      scene_.options.aimed_emission = aimed;
      forward.push_back(trials_.images(before_.direction, 1, film, square, Trials::kImages, true));
    }
    scene_.options.guide = false;
    const PilotImages& best = *std::ranges::min_element(forward, {}, [](const auto& each) {
      const auto [mean, error] = mean_and_error(each);
      return relative_error(mean, error);
    });
    const std::vector<double> shown = shown_by({&all}, {&rest, &best});
    unguided_ = adjoint_figures(plain, false, shown);
    guided_ = adjoint_figures(led, true, shown);
    const PilotFigures& adjoint = guided_first_ ? guided_ : unguided_;
    PilotFigures others{.photons = PilotFigures::kAdjointOfBoth}, without = others;
    if (both) others = adjoint_figures(rest, guided_first_, shown, others.photons);
    if (hint) without = adjoint_figures(unhinted, guided_first_, shown, without.photons);
    without.hinted = false;
    guided_brings_rest_ = both && guided_first_ && guide_finds_more(unguided_, others);
    const PilotFigures left_to_them = figures_of(PilotFigures::kAdjoint, 1, left, shown);
    result_.tried = {unguided_};
    if (request_.guide) result_.tried.push_back(guided_);
    if (both) result_.tried.push_back(others);
    if (hint) {
      result_.tried.push_back(without);
      if (!hints_pay(others, without)) others = without;
    }
    std::vector<PilotFigures> of_aims;
    for (std::size_t i = 0; i < aims.size(); ++i) {
      PilotFigures& found =
          of_aims.emplace_back(figures_of(PilotFigures::kForward, 1, forward[i], shown));
      found.aimed = aims[i];
      found.cost *= kForwardCost;
      result_.tried.push_back(found);
    }
    AdjointFigures of_adjoint{unguided_, adjoint, others, left_to_them};
    const double gain = choose_forward(of_adjoint, of_aims, kWorthIt);
    if (both && result_.choice.direction == Direction::kAdjoint && gain * kWorthIt > 1.0) {
      second_look(of_adjoint);
      choose_forward(of_adjoint, of_aims, kWorthItCloser);
    }
    if (result_.choice.direction == Direction::kAdjoint) {
      const PilotFigures& surest = *std::ranges::min_element(
          of_aims, {},
          [](const PilotFigures& each) { return relative_error(each.mean, each.mean_error); });
      if (both) result_.unmet = may_be_unmet(of_adjoint, surest);
      look_for_rare_light(film, of_adjoint, surest);
    }
  }

  /// By the way that was chosen.
  void look_for_unmet_parts() {
    if (result_.choice.direction == Direction::kForward) return;
    scene_.options.guide = result_.choice.guided;
    scene_.options.aimed_emission = result_.choice.aimed;
    result_.unmet_parts = find_unmet_parts(scene_, trials_, result_.choice.direction, request_.film,
                                           request_.samples, budget_ / 2, mean_of_probe_);
    scene_.options.guide = false;
  }

  /// What is rare hides in the noise of other light: it is looked for alone.
  void look_for_rare_light(Film film, const AdjointFigures& adjoint, const PilotFigures& forward) {
    scene_.options.aimed_emission = forward.aimed;
    scene_.options.guide = guided_first_;
    const auto light =
        find_rare_light(scene_, trials_, before_.direction, film, kSamples,
                        rare_radiance(mean_of_probe_, pixels_of(request_.film) * request_.samples));
    scene_.options.guide = false;
    if (!light) return;
    for (const auto& [photons, met] : {std::pair{PilotFigures::kRareForward, light->by_forward},
                                       std::pair{PilotFigures::kRareAdjoint, light->by_adjoint}}) {
      result_.tried.push_back({.photons = photons, .mean = met.mean, .mean_error = met.error});
    }
    result_.unmet = std::max(result_.unmet, may_be_missing(*light, adjoint.alone.mean));
    if (!must_be_brought(*light, adjoint.alone.mean)) return;
    result_.unmet = 0.0;
    take(adjoint, {.forward = &forward,
                   .ratio = ratio_with(adjoint.rest, forward),
                   .gain = 1.0,
                   .finds_more = true});
  }

  /// What differs within the large pixels of a small film hides what is gained in small ones.
  void second_look(AdjointFigures& adjoint) {
    scene_.options.guide = guided_first_;
    scene_.lights.set_hints(adjoint.rest.hinted);
    const double pixels = budget_ / kSecondLook / (kSharingImages * kMaxSharingSamples);
    const auto squares = trials_.some_squares(std::max(kFewPatches, pixels / (kPatch * kPatch)),
                                              kPatch, kMaxSharingSamples);
    const PilotImages rest =
        trials_.images(Direction::kBoth, 1, request_.film, squares, kSharingImages);
    scene_.options.guide = false;
    const PilotFigures closer = adjoint_figures(rest, false, shown_by({&rest}, {&rest}));
    adjoint.rest.relative_mse = closer.relative_mse;
    adjoint.rest.of_groups = closer.of_groups;
    adjoint.all.relative_mse = adjoint.rest.relative_mse + adjoint.left.relative_mse;
    adjoint.all.of_groups = of_both(adjoint.rest, adjoint.left, 1.0);
    adjoint.alone = adjoint.all;
  }

  /// The best forward photons, if they pay. Gives how much is gained at most.
  double choose_forward(const AdjointFigures& adjoint, const std::vector<PilotFigures>& of_aims,
                        double worth_it) {
    const ForwardChoice found = choose_forward_photons(adjoint, of_aims, given_ratio(), worth_it);
    if (found.forward != nullptr) take(adjoint, found);
    return found.most_gain;
  }

  void take(const AdjointFigures& adjoint, const ForwardChoice& found) {
    adjoint_ = adjoint.rest;
    forward_ = *found.forward;
    const double error =
        error_of_log_ratio(adjoint.alone.of_groups, of_both(adjoint_, forward_, found.ratio));
    result_.choice = {.direction = before_.direction,
                      .sharing = 1,
                      .aimed = forward_.aimed,
                      .forward_ratio = found.ratio,
                      .gain = found.gain,
                      .finds_more = found.finds_more,
                      .gain_error = error,
                      .hinted = adjoint_.hinted};
  }

  static PilotFigures adjoint_figures(const PilotImages& images, bool guided,
                                      const std::vector<double>& shown,
                                      PilotFigures::Photons photons = PilotFigures::kAdjoint) {
    PilotFigures found = figures_of(photons, 1, images, shown);
    found.guided = guided;
    if (guided) found.cost *= kGuideCost;
    return found;
  }

  void choose_guide() {
    if (request_.direction && result_.choice.direction == Direction::kAdjoint) {
      return choose_guide(unguided_, guided_);
    }
    const Film film = trials_.reduced(kGuidePart * budget_ / 2 / (2 * Trials::kImages * kSamples));
    const auto square = whole(film, kSamples);
    const PilotImages without = trials_.images(result_.choice.direction, 1, film, square);
    scene_.options.guide = true;
    const PilotImages with = trials_.images(result_.choice.direction, 1, film, square);
    scene_.options.guide = false;
    const std::vector<double> shown = shown_by({&without}, {&with});
    const auto before = adjoint_figures(without, false, shown, PilotFigures::kGuide);
    const auto found = adjoint_figures(with, true, shown, PilotFigures::kGuide);
    result_.tried.insert(result_.tried.end(), {before, found});
    choose_guide(before, found);
  }

  /// By what photons did before they were guided, and then.
  void choose_guide(const PilotFigures& before, const PilotFigures& found) {
    if (!(before.relative_mse > 0.0 && found.relative_mse > 0.0)) return;
    const double less = found.relative_mse / before.relative_mse;
    // Both directions were compared by photons that are guided.
    const bool compared = guided_first_ && result_.choice.direction != Direction::kAdjoint;
    PilotFigures unguided = adjoint_, guided = adjoint_;
    (compared ? unguided.relative_mse : guided.relative_mse) *= compared ? 1.0 / less : less;
    unguided.cost = before.cost;
    guided.cost = found.cost;
    const double ratio = ratio_with(guided, forward_), other_ratio = ratio_with(unguided, forward_);
    const double gain =
        product_of_both(unguided, forward_, other_ratio) / product_of_both(guided, forward_, ratio);
    if (guide_loses_light(before, found)) {
      result_.fault = PilotResult::Fault::kGuided;
      result_.differs_by = found.mean / before.mean - 1.0;
      return;
    }
    const bool finds_more = guide_finds_more(before, found) || (compared && guided_brings_rest_);
    const double error = error_of_log_ratio(before.of_groups, found.of_groups);
    result_.choice.guided = finds_more || is_gain(gain, error);
    scene_.options.guide = result_.choice.guided;
    adjoint_ = result_.choice.guided ? guided : unguided;
    result_.choice.forward_ratio = result_.choice.guided ? ratio : other_ratio;
    if (!result_.choice.guided) return;
    if (!compared) {
      result_.choice.gain *= gain;
      result_.choice.gain_error = math::hypot(result_.choice.gain_error, error);
    }
    result_.choice.finds_more = result_.choice.finds_more || finds_more;
  }

  void choose_sharing() {
    // Half of the budget was for the direction, if that was open.
    const double budget = std::min(result_.tried.empty() ? budget_ : budget_ / 2, kMaxSamples / 2);
    const double all = budget / (2 * kSharingImages);
    const double enough = std::min<double>(kEnoughSquares, trials_.squares_of_film(kSquare));
    std::uint32_t samples = kSamples;
    // Not 32: the grid of blocks stands still so long, and then sharing seems to lose nothing where
    // light is direct; at 64 samples it loses a factor of three (colour chart).
    constexpr double kPixels = kSquare * kSquare;
    if (kMaxSharingSamples * kPixels * enough <= all) samples = kMaxSharingSamples;
    const double wanted = std::max(1.0, std::floor(all / samples / kPixels));
    const auto film = trials_.some_squares(wanted, kSquare, samples);
    const auto first = film.begin() + static_cast<std::ptrdiff_t>(std::min(kParts, film.size()));
    PilotImages alone, shared;
    auto [gains, ratio] = gains_of_sharing({film.begin(), first}, alone, shared);
    // Of one part of the film alone the error is infinite.
    const auto sure_gain = [&] {
      const std::optional<double> gain = sharing_pays(gains, kWorthIt);
      const double error = error_of_log_ratio(alone_.of_squares, shared_.of_squares);
      return gain && is_gain(*gain, error) ? gain : std::nullopt;
    };
    // The first squares, one for each part of the film, may decide alone.
    const bool plain =
        votes_are_plain(gains, kWorthIt) && (sure_gain() || !sharing_pays(gains, kWorthIt));
    if (first != film.end() && !plain) {
      std::tie(gains, ratio) = gains_of_sharing({first, film.end()}, alone, shared);
    }
    const std::optional<double> gain = sure_gain();
    if (!gain) return;
    if (const double differ = means_differ(alone_.means_of_squares, shared_.means_of_squares);
        differ != 0.0) {
      result_.fault = PilotResult::Fault::kShared;
      result_.differs_by = differ;
      return;
    }
    result_.choice.sharing = 16;
    result_.choice.forward_ratio = ratio;
    result_.choice.gain *= *gain;
    result_.choice.gain_error = math::hypot(
        result_.choice.gain_error, error_of_log_ratio(alone_.of_squares, shared_.of_squares));
  }

  double ratio_with(const PilotFigures& adjoint, const PilotFigures& forward) const {
    const std::optional<double> given = given_ratio();
    return given ? *given : best_forward_ratio(adjoint, forward);
  }
  std::optional<double> given_ratio() const {
    if (before_.direction != Direction::kBoth) return 1.0;
    if (!request_.ratio) return before_.forward_ratio;
    return std::nullopt;
  }

  /// By parts of the film, when more squares of it are added to the images of pixels alone and of
  /// 16 that share; and the ratio of forward photons to these.
  std::pair<std::vector<double>, double> gains_of_sharing(const std::vector<TileRange>& squares,
                                                          PilotImages& alone, PilotImages& shared) {
    const auto add = [&](PilotImages& to, std::uint32_t sharing) {
      PilotImages more =
          trials_.images(result_.choice.direction, sharing, request_.film, squares, kSharingImages);
      to.samples = more.samples;
      to.images.resize(more.images.size());
      for (std::size_t i = 0; i < more.images.size(); ++i) {
        std::ranges::move(more.images[i], std::back_inserter(to.images[i]));
      }
    };
    add(alone, 1);
    add(shared, 16);
    const std::vector<double> shown = shown_by({&alone}, {&shared});
    const PilotFigures one = figures_of(PilotFigures::kSharing, 1, alone, shown);
    PilotFigures sixteen = figures_of(PilotFigures::kSharing, 16, shared, shown);
    sixteen.cost = one.cost + kQueryCost * (sixteen.cost - one.cost);
    alone_ = one;
    shared_ = sixteen;
    std::erase_if(result_.tried, [](const PilotFigures& before) {
      return before.photons == PilotFigures::kSharing;
    });
    result_.tried.insert(result_.tried.end(), {one, sixteen});
    return gains_of_parts(sixteen, one);
  }

  /// How much more efficient `one` is than `other`, each with what forward photons add, in those
  /// parts of the film that have any noise; and the ratio of forward photons to `one`.
  ///
  /// Squares of the film show what adjoint photons bring alone, so of their errors only how many
  /// times less they are is told: what forward ones leave to them was measured beside these.
  std::pair<std::vector<double>, double> gains_of_parts(const PilotFigures& one,
                                                        const PilotFigures& other) const {
    const auto beside = [&](double part_of_error, double cost) {
      PilotFigures adjoint = adjoint_;
      adjoint.relative_mse *= part_of_error;
      adjoint.cost = cost;
      return adjoint;
    };
    const double less = other.relative_mse > 0.0 ? one.relative_mse / other.relative_mse : 1.0;
    const double ratio = ratio_with(beside(less, one.cost), forward_),
                 other_ratio = result_.choice.forward_ratio;
    const std::size_t squares = one.of_squares.size();
    const std::size_t parts = std::min(kParts, squares);
    std::vector<double> gains;
    for (std::size_t part = 0; part < parts; ++part) {
      double error = 0.0, other_error = 0.0;
      for (std::size_t square = part; square < squares; square += parts) {
        error += one.of_squares[square];
        other_error += other.of_squares[square];
      }
      if (!(other_error > 0.0)) continue;
      const double product =
          product_of_both(beside(error / other_error, one.cost), forward_, ratio);
      const double other_product = product_of_both(beside(1.0, other.cost), forward_, other_ratio);
      if (product > 0.0 && other_product > 0.0) gains.push_back(other_product / product);
    }
    return {gains, ratio};
  }

  Scene& scene_;
  const PilotRequest request_;
  const TracingOptions before_;
  Trials trials_;
  PilotResult result_{};
  /// Of forward photons, where they take part, and of the adjoint ones beside them.
  PilotFigures forward_{.photons = PilotFigures::kForward};
  PilotFigures adjoint_{.photons = PilotFigures::kAdjoint, .relative_mse = 1.0};
  /// Adjoint photons alone, where they may be guided; whether they were for comparing directions.
  bool guided_first_ = false;
  /// Those that are guided brought more than all that others met, even without what forward photons
  /// bring: a bright sample of others can hide that when both are compared again.
  bool guided_brings_rest_ = false;
  PilotFigures unguided_{.photons = PilotFigures::kAdjoint};
  PilotFigures guided_{.photons = PilotFigures::kAdjoint};
  /// Where sharing was tried.
  PilotFigures alone_{.photons = PilotFigures::kSharing}, shared_ = alone_;
  /// Y, cd/m2.
  double mean_of_probe_ = 0.0;
  const double budget_;
};

}  // namespace

PilotResult run_pilot(Scene& scene, const PilotRequest& request) {
  return Pilot(scene, request).run();
}

}  // namespace nocturne

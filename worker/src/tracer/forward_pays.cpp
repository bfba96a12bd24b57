#include "tracer/forward_pays.h"

#include <algorithm>

#include "math/functions.h"

namespace nocturne {
namespace {

/// Ratios of forward photons that may be chosen, the part of the time that each kind keeps at
/// least, and how many times better another ratio than 1 must be.
constexpr double kLeastRatio = 1.0 / 16, kMostRatio = 64.0, kLeastTime = 1.0 / 16,
                 kRatioPays = 1.05;
/// Guided photons that found so many times as much light, in most of the four images: one bright
/// sample is a standard error from zero, of two images 1.7, of three 3.
constexpr double kHardlyFound = 8.0, kFoundAgain = 2.0;
/// Standard errors by which photons must find more to keep their hints, which somebody gave.
constexpr double kHintsFindMore = 2.0;

/// How many times less error for the same time both kinds together have than photons from the
/// sensor `alone`.
double gain_of_both(const PilotFigures& alone, const PilotFigures& rest,
                    const PilotFigures& forward, double ratio) {
  return alone.relative_mse * alone.cost / product_of_both(rest, forward, ratio);
}

}  // namespace

double product_of_both(const PilotFigures& adjoint, const PilotFigures& forward, double ratio) {
  return (adjoint.relative_mse + forward.relative_mse / ratio) *
         (adjoint.cost + ratio * forward.cost);
}

double best_forward_ratio(const PilotFigures& adjoint, const PilotFigures& forward) {
  double best = 1.0, least = product_of_both(adjoint, forward, best);
  for (double ratio = kLeastRatio; ratio <= kMostRatio; ratio *= 2.0) {
    const double of_forward = ratio * forward.cost, all = adjoint.cost + of_forward;
    if (of_forward < kLeastTime * all || adjoint.cost < kLeastTime * all) continue;
    const double product = product_of_both(adjoint, forward, ratio);
    // A ratio of 1 keeps small films in one piece.
    if (product < (best == 1.0 ? 1.0 / kRatioPays : 1.0) * least) {
      best = ratio;
      least = product;
    }
  }
  return best;
}

bool guide_finds_more(const PilotFigures& unguided, const PilotFigures& guided) {
  const double apart = kMissed * math::hypot(unguided.mean_error, guided.mean_error);
  const bool found_again = guided.mean > kFoundAgain * guided.mean_error;
  return guided.mean - unguided.mean > apart ||
         (found_again && guided.mean > kHardlyFound * unguided.mean);
}

bool guide_loses_light(const PilotFigures& unguided, const PilotFigures& guided) {
  return unguided.mean - guided.mean > kApart * math::hypot(unguided.mean_error, guided.mean_error);
}

bool is_gain(double gain, double error, double worth_it) {
  return gain > worth_it && math::log(gain) > error;
}

bool guide_pays(const PilotFigures& unguided, const PilotFigures& guided) {
  const double gain = unguided.relative_mse * unguided.cost / (guided.relative_mse * guided.cost);
  return guide_finds_more(unguided, guided) ||
         (!guide_loses_light(unguided, guided) &&
          is_gain(gain, error_of_log_ratio(unguided.of_groups, guided.of_groups)));
}

bool hints_pay(const PilotFigures& with, const PilotFigures& without) {
  const double apart = kHintsFindMore * math::hypot(with.mean_error, without.mean_error);
  const double gain = with.relative_mse * with.cost / (without.relative_mse * without.cost);
  return with.mean - without.mean > apart ||
         !is_gain(gain, error_of_log_ratio(with.of_groups, without.of_groups), 1.0);
}

ForwardPays forward_pays(const AdjointFigures& adjoint, const PilotFigures& forward, double ratio,
                         double worth_it) {
  const bool unseen = adjoint.left.mean == 0.0 && adjoint.left.mean_error == 0.0;
  if (!(forward.mean > 0.0) || forward.mean_error > (unseen ? kSeen : kCertain) * forward.mean) {
    return ForwardPays::kNot;
  }
  // Noise tells how wrong an image is, and nobody would see that this light is not there.
  if (unseen) return ForwardPays::kFindsMore;
  // What one of the two has not found at all makes no noise: a way that is too dark only looks
  // good.
  const double apart = kApart * math::hypot(adjoint.left.mean_error, forward.mean_error);
  if (adjoint.left.mean - forward.mean > apart) return ForwardPays::kNot;
  if (forward.mean - adjoint.left.mean > apart) return ForwardPays::kFindsMore;
  return gain_of_both(adjoint.all, adjoint.rest, forward, ratio) > worth_it
             ? ForwardPays::kLessError
             : ForwardPays::kNot;
}

double may_be_unmet(const AdjointFigures& adjoint, const PilotFigures& forward) {
  const bool certain = forward.mean_error <= kCertain * forward.mean;
  if (certain || !(forward.mean > 0.0 && adjoint.alone.mean > 0.0)) return 0.0;
  const double most = forward.mean + kAtMost * forward.mean_error;
  return std::max(0.0, most - adjoint.left.mean) / adjoint.alone.mean;
}

ForwardChoice choose_forward_photons(const AdjointFigures& adjoint,
                                     const std::vector<PilotFigures>& of_aims,
                                     std::optional<double> given_ratio, double worth_it) {
  const auto& [alone, all, rest, left] = adjoint;
  ForwardChoice choice;
  for (const PilotFigures& found : of_aims) {
    const double ratio = given_ratio ? *given_ratio : best_forward_ratio(rest, found);
    const double gain = gain_of_both(alone, rest, found, ratio);
    choice.most_gain = std::max(choice.most_gain, gain);
    const ForwardPays pays = forward_pays(adjoint, found, ratio, worth_it);
    if (pays == ForwardPays::kNot || (choice.forward != nullptr && gain <= choice.gain)) continue;
    // Photons that are not guided may miss light that the others have in common.
    const double apart = kApart * math::hypot(alone.mean_error, rest.mean_error, found.mean_error);
    choice.forward = &found;
    choice.ratio = ratio;
    choice.gain = gain;
    choice.finds_more =
        pays == ForwardPays::kFindsMore || rest.mean + found.mean - alone.mean > apart;
  }
  return choice;
}

}  // namespace nocturne

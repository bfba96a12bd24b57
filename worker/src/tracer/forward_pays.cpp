#include "tracer/forward_pays.h"

#include "math/functions.h"

namespace nocturne {
namespace {

/// Ratios of forward photons that may be chosen, the part of the time that each kind keeps at
/// least, and how many times better another ratio than 1 must be.
constexpr double kLeastRatio = 1.0 / 16, kMostRatio = 64.0, kLeastTime = 1.0 / 16,
                 kRatioPays = 1.05;
/// Forward photons whose mean is less certain have hardly found the sensor yet; where adjoint ones
/// have found nothing at all of the same light, few are enough.
constexpr double kCertain = 0.2, kSeen = 0.5;
/// Standard errors by which photons must find more to keep their hints, which somebody gave.
constexpr double kHintsFindMore = 2.0;

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

bool hints_pay(const PilotFigures& with, const PilotFigures& without) {
  const double apart = kHintsFindMore * math::hypot(with.mean_error, without.mean_error);
  return with.mean - without.mean > apart ||
         with.relative_mse * with.cost <= without.relative_mse * without.cost;
}

ForwardPays forward_pays(const PilotFigures& adjoint, const PilotFigures& rest,
                         const PilotFigures& left, const PilotFigures& forward, double ratio) {
  const bool unseen = left.mean == 0.0 && left.mean_error == 0.0;
  if (!(forward.mean > 0.0) || forward.mean_error > (unseen ? kSeen : kCertain) * forward.mean) {
    return ForwardPays::kNot;
  }
  // Noise tells how wrong an image is, and nobody would see that this light is not there.
  if (unseen) return ForwardPays::kFindsMore;
  // What one of the two has not found at all makes no noise: a way that is too dark only looks
  // good.
  const double apart = kApart * math::hypot(left.mean_error, forward.mean_error);
  if (left.mean - forward.mean > apart) return ForwardPays::kNot;
  if (forward.mean - left.mean > apart) return ForwardPays::kFindsMore;
  return adjoint.relative_mse * adjoint.cost > kWorthIt * product_of_both(rest, forward, ratio)
             ? ForwardPays::kLessError
             : ForwardPays::kNot;
}

}  // namespace nocturne

// Whether photons from the luminaires pay, and how many, by what a pilot measured of each kind
// (docs/decisions/0062-ways-are-chosen-by-a-pilot.md).
#pragma once

#include <optional>
#include <vector>

#include "tracer/pilot_figures.h"

namespace nocturne {

/// A way is left for another that is so much better.
constexpr double kWorthIt = 1.25;
/// Standard errors between two means that are told apart; of four images, so few are not enough.
constexpr double kApart = 5.0;
/// And those between two ways of which one seems to miss light that the other is known to look for:
/// where chance alone says so, the other is right as well, and costs what it costs.
constexpr double kMissed = 2.5;
/// Forward photons whose mean is less certain have hardly found the sensor yet; where adjoint ones
/// have found nothing at all of the same light, few are enough.
constexpr double kCertain = 0.2, kSeen = 0.5;
/// Standard errors above what was met: so much light there is at most.
constexpr double kAtMost = 2.0;

/// A power of two: how many forward photons for each adjoint one give the least error for the same
/// time. Each kind keeps a sixteenth of the time at least, so that one whose error the pilot has
/// not seen yet is slowed no more than that.
double best_forward_ratio(const PilotFigures& adjoint, const PilotFigures& forward);

/// Error times cost of both kinds together.
double product_of_both(const PilotFigures& adjoint, const PilotFigures& forward, double ratio);

/// Whether a gain is one whose logarithm has such a standard error: worth it, and above 1 by its
/// error. What is left to chance stays as it is.
bool is_gain(double gain, double error, double worth_it = kWorthIt);

/// What is better about forward photons.
enum class ForwardPays { kNot, kLessError, kFindsMore };

/// Photons from the sensor beside which forward ones are judged.
struct AdjointFigures {
  /// Those that bring all light, not guided; and as they were when directions were compared.
  PilotFigures alone, all;
  /// Those that leave to forward ones what these bring (all zero where these bring all), and what
  /// they leave: the difference to `all` with the same numbers.
  PilotFigures rest, left;
};

/// Whether photons start at luminaires. `ratio`: of forward photons to those of `rest`.
ForwardPays forward_pays(const AdjointFigures& adjoint, const PilotFigures& forward,
                         double ratio = 1.0, double worth_it = kWorthIt);

/// Of forward photons by parts of them that are aimed.
struct ForwardChoice {
  /// None where none pay.
  const PilotFigures* forward = nullptr;
  double ratio = 1.0, gain = 0.0;
  bool finds_more = false;
  /// By any of them, whether or not they pay.
  double most_gain = 0.0;
};
/// `ratio` where it is given, else each with its best.
ForwardChoice choose_forward_photons(const AdjointFigures& adjoint,
                                     const std::vector<PilotFigures>& of_aims,
                                     std::optional<double> ratio, double worth_it);

/// How much more light `forward` photons may bring than those from the sensor met of the same kind,
/// at most (two standard errors), in parts of the mean; 0 where forward ones are certain enough to
/// be compared, or found nothing.
double may_be_unmet(const AdjointFigures& adjoint, const PilotFigures& forward);

/// Whether guided photons find light that others miss. Where a way to it is too narrow for chance,
/// those are too dark, and look good.
bool guide_finds_more(const PilotFigures& unguided, const PilotFigures& guided);
/// Or find less, which no light explains.
bool guide_loses_light(const PilotFigures& unguided, const PilotFigures& guided);
/// Or have so much less error that these are left for them.
bool guide_pays(const PilotFigures& unguided, const PilotFigures& guided);

/// Whether photons from the sensor that leave to forward ones what these bring are sent towards
/// important shapes, by what they did `with` these and `without`.
bool hints_pay(const PilotFigures& with, const PilotFigures& without);

}  // namespace nocturne

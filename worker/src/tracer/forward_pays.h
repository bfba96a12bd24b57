// Whether photons from the luminaires pay, and how many, by what a pilot measured of each kind
// (docs/decisions/0062-ways-are-chosen-by-a-pilot.md).
#pragma once

#include "tracer/pilot_figures.h"

namespace nocturne {

/// A way is left for another that is so much better.
constexpr double kWorthIt = 1.25;
/// Standard errors between two means that are told apart; of four images, so few are not enough.
constexpr double kApart = 5.0;

/// A power of two: how many forward photons for each adjoint one give the least error for the same
/// time. Each kind keeps a sixteenth of the time at least, so that one whose error the pilot has
/// not seen yet is slowed no more than that.
double best_forward_ratio(const PilotFigures& adjoint, const PilotFigures& forward);

/// Error times cost of both kinds together.
double product_of_both(const PilotFigures& adjoint, const PilotFigures& forward, double ratio);

/// What is better about forward photons.
enum class ForwardPays { kNot, kLessError, kFindsMore };

/// Whether photons start at luminaires. `adjoint` are photons from the sensor that bring all light,
/// `rest` those that leave to `forward` ones what these bring (all zero where these bring all), and
/// `left` is what they leave: the difference of `adjoint` and `rest` with the same numbers.
/// `ratio`: of forward photons to those of `rest`.
ForwardPays forward_pays(const PilotFigures& adjoint, const PilotFigures& rest,
                         const PilotFigures& left, const PilotFigures& forward, double ratio = 1.0);

/// Whether photons from the sensor that leave to forward ones what these bring are sent towards
/// important shapes, by what they did `with` these and `without`.
bool hints_pay(const PilotFigures& with, const PilotFigures& without);

}  // namespace nocturne

// Which of a pilot's methods has the least error for the same cost, and which miss light.
#pragma once

#include <optional>
#include <vector>

#include "tracer/pilot/pilot_figures.h"

namespace nocturne {

/// What a method did.
struct MethodFigures {
  PilotMethod method;
  /// Zero where it has no photons of the kind.
  PilotFigures sensor, luminaires;
  /// Photons from luminaires for each from the sensor.
  double ratio = 1.0;
  /// Of all its light, Y.
  MeanLight mean;
  /// Photons from luminaires that hardly found the sensor: their mean and error say nothing.
  bool uncertain = false;
  /// Another method found more light, beyond the errors of both.
  bool misses_light = false;
  /// Its merit is that many times worse, up to kWorthIt.
  double handicap = 1.0;

  /// Relative MSE, and what groups of pixels have of it; rays; for each photon from the sensor.
  double error() const { return sensor.relative_mse + luminaires.relative_mse / ratio; }
  GroupErrors errors_of_groups() const;
  double cost() const { return sensor.cost + ratio * luminaires.cost; }
  double product() const { return error() * cost(); }
  /// The figure of merit: error times cost; more where few pixels decide, as the error is then told
  /// too small.
  double merit() const;
  bool comparable() const { return !uncertain && !misses_light; }
};

/// Sharing must be so many times better than each pixel alone; and photons from the sensor alone
/// than those from both ends, which find rare light, unless they are surely better.
constexpr double kWorthIt = 1.25;
/// A ratio of photons from luminaires may be so many times worse than the best, to have more of
/// them: in the larger pixels of a small film those from the sensor have more error than in the
/// render, and the best ratio came out 1.5 times too low in 40 scenes (docs/decisions/0130).
constexpr double kAboutAsGood = 1.1;
/// A mean that is less than so many standard errors is not certain.
constexpr double kCertain = 3.0;

/// Figures of `methods`, in their order. `given_ratio`: of those of both kinds; otherwise each has
/// its best.
std::vector<MethodFigures> figures_of_methods(const std::vector<PilotMethod>& methods,
                                              const ImagesOfKind& images,
                                              std::optional<double> given_ratio);

/// A power of two: how many forward photons for each from the sensor give the least error for the
/// same time; the most of those that are worse by no more than `about`. Each kind keeps a sixteenth
/// of the time at least, so that one whose error the pilot has not seen yet is slowed no more than
/// that.
double best_forward_ratio(const PilotFigures& sensor, const PilotFigures& luminaires,
                          double about = 1.0);

/// Of the methods with photons from luminaires, that whose light from these is most certain; those
/// whose photons from the sensor are guided as `sensor` is come first, if there are any.
const PilotMethod& surest_from_luminaires(const std::vector<PilotMethod>& methods,
                                          const PhotonKind& sensor, const ImagesOfKind& images);

/// By merit; comparable methods come before those that are not.
bool is_better(const MethodFigures& one, const MethodFigures& other);

/// Normal quantiles: one false alarm in a thousand, where it costs a better method; and one in
/// millions, where a fault of the program is reported.
constexpr double kMissed = 3.09, kFault = 5.0;

/// Whether `more` is greater on average than `less`, which were made with the same numbers one by
/// one, beyond chance by so many standard errors (more of them where there are few numbers).
bool is_more(const std::vector<double>& more, const std::vector<double>& less,
             double errors = kMissed);

}  // namespace nocturne

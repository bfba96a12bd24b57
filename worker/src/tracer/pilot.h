// Which way to trace a scene best: a few samples by each that the scene leaves open
// (docs/decisions/0062-ways-are-chosen-by-a-pilot.md).
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"
#include "tracer/pilot_figures.h"
#include "tracer/trace_tile.h"

namespace nocturne {

struct PilotRequest {
  Film film;
  /// Of each pixel, in the render that is to come: the pilot takes a small part of that.
  std::uint32_t samples;
  /// What is open. Direction: adjoint, or what the scene's options say. Aim: whether forward
  /// photons are aimed as these say, or not. Ratio: how many forward photons there are for each
  /// adjoint one, or what the options say.
  bool direction, aim, sharing;
  bool ratio = false;
  /// Guide: whether adjoint photons go where the scene's learned light comes from.
  bool guide = false;
  unsigned threads;
};

/// The way with the least error for the same time.
struct PilotChoice {
  Direction direction;
  std::uint32_t sharing;
  bool aimed;
  /// Forward photons for each adjoint one, where they go both ways.
  double forward_ratio;
  /// How many times less time it takes to the same error than adjoint photons of pixels alone.
  double gain;
  /// These missed light that the way finds, so that `gain` says nothing.
  bool finds_more;
  bool guided = false;
};

struct PilotResult {
  PilotChoice choice;
  std::vector<PilotFigures> tried;
  std::uint64_t photons, rays;
};

/// A power of two: how many forward photons for each adjoint one give the least error for the same
/// time. Each kind keeps an eighth of the time at least, so that one whose error the pilot has not
/// seen yet is slowed no more than that.
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

/// The same choice on every machine and for any number of threads: costs are counted, not timed.
/// The options of `scene`, which was loaded for the direction that its options say, change
/// meanwhile and are at the end what they were. Throws what tracing throws.
PilotResult run_pilot(Scene& scene, const PilotRequest& request);

}  // namespace nocturne

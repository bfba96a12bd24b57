// Which method traces a scene best: a few samples by each that the scene leaves open
// (docs/decisions/0062-ways-are-chosen-by-a-pilot.md).
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"
#include "tracer/pilot/pilot_figures.h"
#include "tracer/pilot/unmet_parts.h"
#include "tracer/trace_tile.h"

namespace nocturne {

struct PilotRequest {
  Film film;
  /// Of each pixel, in the render that is to come: the pilot takes a small part of that.
  std::uint32_t samples;
  /// The open choices. Direction: adjoint, or as the scene's options say. Aim: whether forward
  /// photons are aimed as these say, fewer of them, or none. Ratio: how many forward photons there
  /// are for each adjoint one, or as the options say.
  bool direction, aim, sharing;
  bool ratio = false;
  /// Guide: whether adjoint photons go where the scene's learned light comes from.
  bool guide = false;
  /// Parts: where in the image the chosen method may miss light.
  bool parts = false;
  /// Groups of photons that something was learned from before, a part of what the pilot may take.
  double training_samples = 0.0;
  unsigned threads;
};

/// The method with the least error for the same time.
struct PilotChoice {
  Direction direction;
  std::uint32_t sharing;
  /// Part of the forward photons.
  float aimed;
  /// Forward photons for each adjoint one, where both directions are traced.
  double forward_ratio;
  /// How many times less time it takes to the same error than adjoint photons of pixels alone.
  double gain;
  /// These missed light that the method finds, so that `gain` says nothing.
  bool finds_more;
  /// Standard error of the logarithm of `gain`.
  double gain_error = 0.0;
  bool guided = false;
};

struct PilotResult {
  PilotChoice choice;
  /// What each kind of photons did.
  std::vector<PilotFigures> tried;
  std::uint64_t photons, rays;
  /// Where photons from the sensor alone were chosen: how much more light forward photons may bring
  /// than these met of the same kind, at most (two standard errors), in parts of the mean.
  double unmet = 0.0;
  /// Where in the image the chosen method may miss light.
  std::vector<UnmetPart> unmet_parts;
  /// A method whose mean differs from that of others beyond their errors: a fault, so that it was
  /// not chosen. By how much, in parts of the mean.
  enum class Fault { kNone, kGuided, kShared } fault = Fault::kNone;
  double differs_by = 0.0;
};

/// The same choice on every machine and for any number of threads: costs are counted, not timed.
/// The options of `scene`, which was loaded for the direction that its options say, change
/// meanwhile and are restored at the end. Throws the errors that tracing throws.
PilotResult run_pilot(Scene& scene, const PilotRequest& request);

}  // namespace nocturne

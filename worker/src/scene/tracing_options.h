// How photons are traced. None of it changes what an image converges to, but for max_depth.
#pragma once

#include <cstdint>

#include "sampling/sequence.h"

namespace nocturne {

/// Weights of the mixture density; not negative, sum 1.
struct MixtureWeights {
  float kernel, lights, uniform;
};

/// How directions are drawn where a photon meets a surface.
enum class Estimator {
  /// One photon, from the mixture of all densities.
  kMixture,
  /// A photon from each density at the first vertices, weighted by the power heuristic.
  kSplit,
  /// A photon from the kernel, and one towards the lights that ends on the first ordinary surface.
  kTwoPhotons,
};

/// Which photons make the image.
enum class Direction {
  /// From the sensor to the luminaires.
  kAdjoint,
  /// From the luminaires to a sensor that they can meet.
  kForward,
  /// Each path of light by one of the two (walk.h).
  kBoth,
};

struct TracingOptions {
  static constexpr std::uint32_t kMaxSplitVertices = 8;
  /// A photon caught in clear glass may never end by itself. After so many interactions in a row
  /// that absorb nothing and only reflect or refract, it survives the n-th with 1 - 2 / n. Of those
  /// along the rim of a fine mesh about one in n gets out after n: where all but a few have ended
  /// by then, as by a constant survival, their light is not met.
  static constexpr std::uint32_t kSpecularRouletteAfter = 1000;
  /// Among surfaces that absorb nothing no photon ends by itself either. Beyond so many, the n-th
  /// is survived with at most 1 - 2 / n: n are survived with a probability that falls as 1 / n^2,
  /// so that paths end, and weights grow as n^2, which the albedo's n-th power outweighs in all
  /// moments wherever it is below 1. A constant survival s has a finite second moment only for
  /// albedos below the square root of s.
  static constexpr std::uint32_t kManyBounces = 100'000;
  /// From here on both survive with a constant probability, so that one path in 10^10 of those
  /// caught reaches PathLimits::kMaxRays, which would take its light away: with 1 - 2 / n one in a
  /// million did. Those that are still caught now get out too rarely for moments to matter.
  static constexpr std::uint32_t kSteadyFrom = 1u << 17;

  /// A photon survives a vertex with probability min(1, H h), times its weight inside the minimum
  /// where roulette_by_weight says so.
  float h;
  bool roulette_by_weight;
  /// Vertices before roulette starts.
  std::uint32_t roulette_after;
  /// Interactions after which it is absorbed; surfaces that it passes straight through do not
  /// count.
  std::uint32_t max_depth;
  MixtureWeights mixture;
  Estimator estimator;
  /// Vertices that split.
  std::uint32_t split_vertices;
  /// Photons that travel together: 1 or 4.
  std::uint32_t group;
  /// Pixels of a block that share what their photons find: 16, or 1 where each is alone.
  std::uint32_t sharing;
  Direction direction;
  /// Part of the photons from luminaires that is drawn towards important shapes, [0, 1).
  float aimed_emission;
  /// Photons from luminaires for each from a pixel, where both directions are traced: with another
  /// number than 1 they have separate ranges on any film.
  double forward_ratio;
  SequenceKind sequence;
  std::uint64_t seed;
  /// Photons towards lights go where light was learned to come from, too.
  bool guide = true;
  /// Light of luminaires with a lower radiance does not count, W m-2 sr-1 nm-1: a pilot looks for
  /// bright and rare light alone.
  float least_radiance = 0.0f;
  /// The same of light that mirrors and glass turn into a photon's path: all counts, or only such
  /// light as it is met, or as photons nearly meet it (widened_lamps.h), or the square of the light
  /// that they would find.
  enum class Gathered : std::uint8_t { kWithAll, kMet, kNearlyMet, kNearlyMetSquared };
  Gathered gathered = Gathered::kWithAll;
};

}  // namespace nocturne

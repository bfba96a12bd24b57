// Methods compared in rounds: in each, half as many have four times the samples (successive
// halving; Jamieson and Talwalkar 2016, "Non-stochastic best arm identification").
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "tracer/pilot/compare_methods.h"
#include "tracer/pilot/trials.h"

namespace nocturne {

/// Samples of a pixel in the last round, and of all rounds together for each kind of photons,
/// about.
constexpr std::uint32_t kMostSamplesOfARound = 256;
constexpr double kSamplesOfRounds = 160.0;

class Rounds {
 public:
  /// `film`: a small one, on which all methods are compared; `samples`: of each pixel of the
  /// render, and the most that are compared; `given_ratio`: of photons from luminaires to those
  /// from the sensor, where it is not open.
  Rounds(Trials& trials, Film film, std::uint32_t samples, std::optional<double> given_ratio)
      : trials_(trials),
        film_(film),
        most_samples_(std::min(kMostSamplesOfARound, samples)),
        given_ratio_(given_ratio) {}

  /// The best of them, the plainest of which is the first.
  MethodFigures best_of(const std::vector<PilotMethod>& methods);
  /// Of the plainest method, and of the best that it was compared with, in the last round that it
  /// had part in.
  const MethodFigures& plainest() const { return plainest_; }
  const MethodFigures& best_beside_plainest() const { return beside_plainest_; }

  /// Figures of `methods` by as many samples as the last round had.
  std::vector<MethodFigures> compared(const std::vector<PilotMethod>& methods);
  ImagesOfKind images() {
    return [this](const PhotonKind& kind) -> const PilotImages& { return images_of(kind); };
  }
  std::uint32_t samples() const { return samples_; }
  /// What each kind of photons did.
  const std::map<PhotonKind, PilotFigures>& tried() const { return tried_; }

 private:
  const PilotImages& images_of(const PhotonKind& kind);

  Trials& trials_;
  const Film film_;
  const std::uint32_t most_samples_;
  const std::optional<double> given_ratio_;
  std::uint32_t samples_ = 0;
  std::map<PhotonKind, PilotImages> images_;
  std::map<PhotonKind, PilotFigures> tried_;
  MethodFigures plainest_, beside_plainest_;
};

}  // namespace nocturne

// Stage: samples begin.
#pragma once

#include "tracer/batch.h"

namespace nocturne {

/// Adds one sample, a group of photons, to a batch. Samples are numbered in the order in which they
/// are added.
template <int N, class Estimator, bool Media>
void start(Batch<N, Estimator, Media>& batch, const Start<N>& from,
           const PhotonSequence& sequence) {
  const auto number = static_cast<std::uint32_t>(batch.samples.size());
  batch.samples.push_back({from.wavelengths, from.time, from.spread, from.flux});
  if constexpr (Media) batch.flights.emplace_back(batch.scene, from.wavelengths, batch.limits);
  if (!(largest(from.flux) > 0.0f)) return;  // nothing was emitted
  batch.groups.push_back({.ray = from.ray,
                          .departure = from.departure,
                          .sample = number,
                          .width = from.width,
                          .weight = 1.0f,
                          .inside = from.inside,
                          .ends = {},
                          .mis = {},
                          .sequence = sequence});
}

}  // namespace nocturne

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
  BatchSample<N>& sample = batch.samples.emplace_back();
  sample.wavelengths = from.wavelengths;
  sample.time = from.time;
  sample.spread = from.spread;
  sample.flux = from.flux;
  if constexpr (Media) batch.flights.emplace_back(batch.scene, from.wavelengths, batch.limits);
  if (!(largest(from.flux) > 0.0f)) return;  // nothing was emitted
  Group<N>& group = batch.groups.emplace_back(sequence);
  group.ray = from.ray;
  group.departure = from.departure;
  group.sample = group.tally = number;
  group.width = from.width;
  group.inside = from.inside;
}

}  // namespace nocturne

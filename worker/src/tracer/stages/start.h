// Stage: samples begin.
#pragma once

#include <limits>

#include "pdfs/directions.h"
#include "tracer/stages/travel.h"

namespace nocturne {

/// A film is a vertex whose kernel is the cosine: the photon that starts by it shares what lights
/// bring with another, which starts towards them.
template <int N, class Estimator, bool Media>
void start_towards_lights(Batch<N, Estimator, Media>& batch, Vec3 film_normal) {
  const LightDirections& lights = batch.scene.lights;
  if (lights.empty()) return;
  Group<N>& by_cosine = batch.groups.back();
  const LightSamplingContext here{.position = by_cosine.ray.origin,
                                  .normal = film_normal,
                                  .time = batch.sample_of(by_cosine).time};
  const auto density = [&](Vec3 direction) {
    return std::max(0.0f, dot(film_normal, direction)) / kPi;
  };
  by_cosine.mis = {MisTechnique::kKernel, here, by_cosine.ray.direction,
                   density(by_cosine.ray.direction)};
  PhotonSequence sequence = by_cosine.sequence.branch(1);
  const Uniform4 u = sequence.next();
  const auto drawn = lights.sample(here, u[2], u[0], u[1]);
  if (!drawn || !(density(drawn->direction) > 0.0f)) return;
  Group<N> photon = by_cosine;
  photon.sequence = sequence;
  photon.ray.direction = drawn->direction;
  photon.weight *= Spectral<N>(density(drawn->direction));
  photon.mis = {MisTechnique::kLights,     here,       drawn->direction,
                density(drawn->direction), drawn->pdf, worth_outside(batch, photon)};
  batch.groups.push_back(photon);
}

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
  Group<N>& group = batch.groups.emplace_back(from, sequence);
  group.sample = group.tally = number;
  if constexpr (Batch<N, Estimator, Media>::kAdjoint) {
    if (from.film_normal) start_towards_lights(batch, *from.film_normal);
  } else {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    group.mis.context.position = from.distant ? Vec3{kFar, kFar, kFar} : from.ray.origin;
  }
}

}  // namespace nocturne

// Stage: groups arrive, weakened by the media they crossed, and the light they meet is counted.
#pragma once

#include <array>

#include "tracer/stages/travel.h"

namespace nocturne {

/// Up to a hit.
template <int N, class Batch>
void arrive(Batch& batch, Group<N>& group, const Hit& hit) {
  const BatchSample<N>& sample = batch.sample_of(group);
  if (!group.inside.empty()) absorb(batch, group, way_to(group, hit));
  group.width += sample.spread * hit.distance;
  if (batch.is_medium(hit)) {
    batch.estimator.glows(sample, group, hit);
  } else {
    batch.estimator.arrives(sample, group, hit);
  }
}

/// Most photons that went towards lights end without another look at the surface.
template <class Batch, int N>
bool ends_here(const Batch& batch, const Group<N>& group, const Hit& hit) {
  return group.mis.technique == MisTechnique::kLights &&
         (batch.occlusion_decides || !batch.scene.materials[hit.surface].has_delta_lobe);
}

// Data far away in memory are requested so many groups before they are counted.
inline constexpr std::size_t kAhead = 8;

template <int N, class Estimator, bool Media>
void count(Batch<N, Estimator, Media>& batch) {
  constexpr bool kAdjoint = Batch<N, Estimator, Media>::kAdjoint;
  batch.contacts.clear();
  std::array<LightDirections::SkyPlace, kAhead> places;
  const auto expect = [&](std::size_t i) {
    const auto& environment = batch.scene.lights.environment();
    if (!kAdjoint || !environment || i >= batch.groups.size() || batch.hits[i]) return;
    places[i % kAhead] = environment->expect(batch.groups[i].ray.direction);
  };
  for (std::size_t i = 0; i < kAhead; ++i) expect(i);
  for (std::size_t i = 0; i < batch.groups.size(); ++i) {
    Group<N>& group = batch.groups[i];
    Encounter& met = batch.encounters[i];
    std::optional<Hit>& hit = batch.hits[i];
    const BatchSample<N>& sample = batch.sample_of(group);
    if (hit) {
      const Contacts touching =
          contacts_of(batch.scene, group.ray, sample.time, group.departure, *hit);
      if (!touching.empty()) {
        met.contacts = static_cast<std::uint32_t>(batch.contacts.size());
        batch.contacts.push_back(touching);
      }
    }
    if constexpr (kAdjoint) {
      batch.estimator.flies(sample, group, hit ? &*hit : nullptr, places[i % kAhead]);
    } else {
      batch.estimator.flies(sample, group, hit ? &*hit : nullptr);
    }
    expect(i + kAhead);
    if (hit) arrive(batch, group, *hit);
    met.ended = !hit || ends_here(batch, group, *hit);
  }
}

}  // namespace nocturne

// Stage: groups arrive, weakened by what lies on their way, and what they meet is counted.
#pragma once

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

template <int N, class Estimator, bool Media>
void count(Batch<N, Estimator, Media>& batch) {
  batch.contacts.clear();
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
    batch.estimator.flies(sample, group, hit ? &*hit : nullptr);
    if (hit) arrive(batch, group, *hit);
    met.ended = !hit || ends_here(batch, group, *hit);
  }
}

}  // namespace nocturne

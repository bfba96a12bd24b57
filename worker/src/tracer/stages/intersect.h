// Stage: the nearest surface on the ray of each group.
#pragma once

#include "tracer/batch.h"

namespace nocturne {

template <int N, class Estimator, bool Media>
void intersect(Batch<N, Estimator, Media>& batch) {
  batch.rays += batch.groups.size();
  batch.timed_rays.clear();
  for (const Group<N>& group : batch.groups) {
    batch.timed_rays.push_back(
        {.ray = group.ray, .time = batch.sample_of(group).time, .departure = &group.departure});
  }
  batch.hits.resize(batch.groups.size());
  batch.scene.geometry.intersect(batch.timed_rays, batch.hits);
  if (!batch.scene.medium_interfaces.empty()) {
    for (std::size_t i = 0; i < batch.groups.size(); ++i) {
      InteriorList& inside = batch.groups[i].inside;
      if (batch.hits[i] || inside.empty()) continue;
      inside = inside.without_closed(batch.scene.medium_interfaces);
    }
  }
  batch.encounters.assign(batch.groups.size(), {});
}

}  // namespace nocturne

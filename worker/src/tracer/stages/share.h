// Stage: every first vertex of a block takes part in what the second ones will find. Estimates over
// all y_i of the block, for the pixel whose first vertex is x_j:
//   I_j = sum over i of  f(x_j, y_i) V(x_j, y_i) cos cos / r^2  L(y_i -> x_j) / sum over k of
//   p_k(y_i)
// where p_k is the density, by area at y_i, with which the photon from x_k would have met it: zero
// where it would not have.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "tracer/stages/offer.h"

namespace nocturne {

/// What a photon from `first`, whose kernel is bound, brings from `second` if nothing is between.
/// False where it would never go there.
template <int N, class Kernel>
bool meet(const FirstVertex<N>& first, const Kernel& kernel, const SecondVertex<N>& second,
          Meeting<N>& meeting) {
  const Vec3 way = second.hit.position - first.hit.position;
  const float square = dot(way, way);
  if (!(square > 0.0f)) return false;
  const float inverse = 1.0f / std::sqrt(square);
  const Vec3 direction = inverse * way;
  const float cosine = -dot(second.normal, direction);
  if (!(cosine > 0.0f) || !(dot(second.kernel_normal, direction) < 0.0f)) return false;
  const Vec3 wi = first.frame.to_local(direction);
  if (!may_send(kernel, first.normal, direction, wi)) return false;
  const float by_area = cosine * inverse * inverse;
  meeting.value = by_area * kernel.value(first.wo, wi);
  // A photon that would carry nothing there ends.
  meeting.density =
      only((first.survival * by_area) * kernel.pdf(first.wo, wi), alive(meeting.value));
  return largest(meeting.density) > 0.0f;
}

template <int N>
TimedRay way_between(const FirstVertex<N>& first, const SecondVertex<N>& second, float time) {
  const Vec3 towards = second.hit.position - first.hit.position;
  const Vec3 from = leave_surface(first.hit, towards), to = leave_surface(second.hit, -towards);
  const Vec3 way = to - from;
  const float distance = length(way);
  return {.ray = {from, (1.0f / distance) * way}, .time = time, .end = distance};
}

/// Of one block: its samples, and the second vertices of these.
template <int N, class Estimator, bool Media>
void share_block(Batch<N, Estimator, Media>& batch, std::uint32_t first_sample,
                 std::uint32_t end_sample, std::span<const SecondVertex<N>> seconds) {
  std::vector<Meeting<N>>& meetings = batch.sharing.meetings;
  meetings.clear();
  batch.timed_rays.clear();
  const float time = batch.samples[first_sample].time;
  for (std::uint32_t sample = first_sample; sample < end_sample; ++sample) {
    const auto& first = batch.sharing.firsts[sample];
    if (!first) continue;
    visit_bound<N>(batch.scene.kernels, first->kernel, first->shading, [&](const auto& kernel) {
      for (std::uint32_t i = 0; i < seconds.size(); ++i) {
        const auto& from = batch.sharing.firsts[seconds[i].sample];
        if (from->diffuse_like != first->diffuse_like) continue;
        Meeting<N> meeting{.sample = sample, .second = i, .value = 0.0f, .density = 0.0f};
        const bool own = seconds[i].sample == sample;
        if (!meet(*first, kernel, seconds[i], meeting) && !own) continue;
        meetings.push_back(meeting);
        if (!own) batch.timed_rays.push_back(way_between(*first, seconds[i], time));
      }
    });
  }
  batch.rays += batch.timed_rays.size();
  batch.blocked.resize(batch.timed_rays.size());
  batch.scene.geometry.occluded(batch.timed_rays, batch.blocked);

  std::vector<Spectral<N>>& densities = batch.sharing.densities;
  densities.assign(seconds.size(), Spectral<N>(0.0f));
  std::size_t ray = 0, kept = 0;
  for (const Meeting<N>& meeting : meetings) {
    const bool own = seconds[meeting.second].sample == meeting.sample;
    if (!own && batch.blocked[ray++] != 0) continue;
    densities[meeting.second] += meeting.density;
    meetings[kept++] = meeting;
  }
  meetings.resize(kept);
  for (const Meeting<N>& meeting : meetings) {
    const SecondVertex<N>& second = seconds[meeting.second];
    const Spectral<N>& density = densities[meeting.second];
    // Of one's own, what the photon carries is value over density already; and if that is rounded
    // to nothing, then nobody else takes it.
    const bool own = second.sample == meeting.sample;
    batch.sharing.taken.push_back({meeting.sample, second.tally,
                                   each(
                                       [own](float carried, float value, float mine, float all) {
                                         if (!(carried > 0.0f)) return 0.0f;
                                         if (!(all > 0.0f)) return own ? carried : 0.0f;
                                         return (own ? carried * mine : value) / all;
                                       },
                                       second.weight, meeting.value, meeting.density, density)});
  }
}

template <int N, class Estimator, bool Media>
void share(Batch<N, Estimator, Media>& batch) {
  Sharing<N>& sharing = batch.sharing;
  std::stable_sort(
      sharing.seconds.begin(), sharing.seconds.end(),
      [](const SecondVertex<N>& a, const SecondVertex<N>& b) { return a.sample < b.sample; });
  std::size_t second = 0;
  for (std::size_t block = 0; block < sharing.blocks.size(); ++block) {
    const std::uint32_t end = block + 1 < sharing.blocks.size()
                                  ? sharing.blocks[block + 1]
                                  : static_cast<std::uint32_t>(batch.samples.size());
    const std::size_t begin = second;
    while (second < sharing.seconds.size() && sharing.seconds[second].sample < end) ++second;
    share_block(batch, sharing.blocks[block], end,
                std::span<const SecondVertex<N>>(sharing.seconds).subspan(begin, second - begin));
  }
}

}  // namespace nocturne

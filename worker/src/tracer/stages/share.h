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
  if (!(cosine > 0.0f) || !(dot(second.frame.normal, direction) < 0.0f)) return false;
  const Vec3 wi = first.frame.to_local(direction);
  if (!may_send(kernel, first.normal, direction, wi)) return false;
  const float by_area = cosine * inverse * inverse;
  const Evaluation<N> there = evaluate<N>(kernel, first.wo, wi);
  meeting.value = by_area * there.value;
  // A photon that would carry nothing there ends.
  meeting.density = only((first.survival * by_area) * there.pdf, alive(meeting.value));
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

/// All meetings of a block, those of each second vertex together: the ways to it are close to each
/// other, and one packet follows them.
template <int N, class Estimator, bool Media>
void find_meetings(Batch<N, Estimator, Media>& batch, std::uint32_t first_sample,
                   std::uint32_t end_sample, std::span<const SecondVertex<N>> seconds) {
  BlockMeetings<N>& block = batch.sharing.block;
  block.clear(seconds.size());
  for (std::uint32_t sample = first_sample; sample < end_sample; ++sample) {
    const auto& first = batch.sharing.firsts[sample];
    if (!first) continue;
    visit_bound<N>(batch.scene.kernels, first->kernel, first->shading, [&](const auto& kernel) {
      for (std::uint32_t i = 0; i < seconds.size(); ++i) {
        const auto& from = batch.sharing.firsts[seconds[i].sample];
        if (from->diffuse_like != first->diffuse_like) continue;
        Meeting<N> meeting{.sample = sample, .second = i, .value = 0.0f, .density = 0.0f};
        if (meet(*first, kernel, seconds[i], meeting) || seconds[i].sample == sample) {
          block.add(meeting);
        }
      }
    });
  }
  block.sort();
}

/// Leaves out the meetings with something between.
template <int N, class Estimator, bool Media>
void keep_free(Batch<N, Estimator, Media>& batch, float time,
               std::span<const SecondVertex<N>> seconds) {
  std::vector<Meeting<N>>& meetings = batch.sharing.block.sorted;
  const auto own = [&](const Meeting<N>& meeting) {
    return seconds[meeting.second].sample == meeting.sample;
  };
  batch.timed_rays.clear();
  for (const Meeting<N>& meeting : meetings) {
    if (own(meeting)) continue;
    const FirstVertex<N>& first = *batch.sharing.firsts[meeting.sample];
    batch.timed_rays.push_back(way_between(first, seconds[meeting.second], time));
  }
  batch.rays += batch.timed_rays.size();
  batch.blocked.resize(batch.timed_rays.size());
  batch.scene.geometry.occluded(batch.timed_rays, batch.blocked, Ways::kTogether);
  std::size_t ray = 0;
  std::erase_if(meetings, [&](const Meeting<N>& meeting) {
    return !own(meeting) && batch.blocked[ray++] != 0;
  });
}

/// What a meeting's first vertex has of the light that its second one sends to all sides alike.
template <int N>
Spectral<N> factor_of(const Meeting<N>& meeting, const SecondVertex<N>& second,
                      const Spectral<N>& all) {
  // Of one's own, what the photon carries is value over density already; and if that is rounded to
  // nothing, then nobody else takes it.
  const bool own = second.sample == meeting.sample;
  return each(
      [own](float carried, float value, float mine, float sum) {
        if (!(carried > 0.0f)) return 0.0f;
        if (!(sum > 0.0f)) return own ? carried : 0.0f;
        return (own ? carried * mine : value) / sum;
      },
      second.weight, meeting.value, meeting.density, all);
}

/// By which anything came.
template <int N, class Estimator, bool Media, class F>
void for_each_arrival(const Batch<N, Estimator, Media>& batch, const SecondVertex<N>& second,
                      const F& f) {
  for (std::uint32_t i = second.arrivals; i != Arrival<N>::kNone;) {
    const Arrival<N>& arrival = batch.sharing.arrivals[i];
    if (batch.estimator.found(arrival.tally)) f(arrival);
    i = arrival.next;
  }
}

/// Of a second vertex whose kernel is not Lambert's: the diffuse part of each arrival goes to all
/// who met it, the rest to its own sample.
template <int N, class Estimator, bool Media, class Kernel>
void take_arrivals(Batch<N, Estimator, Media>& batch, std::span<const Meeting<N>> meetings,
                   const SecondVertex<N>& second, const Kernel& kernel, const Spectral<N>& all) {
  std::vector<Counted<N>>& counted = batch.sharing.counted;
  counted.clear();
  for_each_arrival(batch, second, [&](const Arrival<N>& arrival) {
    const Spectral<N> value = kernel.value(second.wo, arrival.wi);
    counted.push_back({arrival.wi, arrival.tally, ratio(Spectral<N>(1.0f), value)});
    const Spectral<N> rest = value - kernel.diffuse_value(second.wo, arrival.wi);
    batch.estimator.take(second.sample, arrival.tally, second.weight * ratio(rest, value));
  });
  for (const Meeting<N>& meeting : meetings) {
    const Vec3 towards = batch.sharing.firsts[meeting.sample]->hit.position;
    const Vec3 wo = meeting.sample == second.sample
                        ? second.wo
                        : second.frame.to_local(normalized(towards - second.hit.position));
    const Spectral<N> factor = factor_of(meeting, second, all);
    for (const Counted<N>& each : counted) {
      batch.estimator.take(meeting.sample, each.tally,
                           factor * kernel.diffuse_value(wo, each.wi) * each.inverse);
    }
  }
}

/// Of one block: its samples, and the second vertices of these that found something.
template <int N, class Estimator, bool Media>
void share_block(Batch<N, Estimator, Media>& batch, std::uint32_t first_sample,
                 std::uint32_t end_sample, std::span<const SecondVertex<N>> seconds) {
  find_meetings(batch, first_sample, end_sample, seconds);
  keep_free(batch, batch.samples[first_sample].time, seconds);
  std::span<const Meeting<N>> left = batch.sharing.block.sorted;
  while (!left.empty()) {
    const std::uint32_t index = left.front().second;
    const SecondVertex<N>& second = seconds[index];
    Spectral<N> all = 0.0f;
    std::size_t count = 0;
    while (count < left.size() && left[count].second == index) all += left[count++].density;
    const std::span<const Meeting<N>> meetings = left.first(count);
    left = left.subspan(count);
    if (!second.lambertian) {
      visit_bound<N>(batch.scene.kernels, second.kernel, second.shading,
                     [&]<class Kernel>(const Kernel& kernel) {
                       if constexpr (HasDiffusePart<Kernel, N>) {
                         take_arrivals(batch, meetings, second, kernel, all);
                       }
                     });
      continue;
    }
    for (const Meeting<N>& meeting : meetings) {
      batch.estimator.take(meeting.sample, second.tally, factor_of(meeting, second, all));
    }
  }
}

/// Whether there is anything to share.
template <int N, class Estimator, bool Media>
bool found_anything(const Batch<N, Estimator, Media>& batch, const SecondVertex<N>& second) {
  if (second.lambertian) return batch.estimator.found(second.tally);
  bool any = false;
  for_each_arrival(batch, second, [&](const Arrival<N>&) { any = true; });
  return any;
}

/// At the end of a batch, when what is found from each second vertex on is known: where that is
/// nothing, there is nothing to share.
template <int N, class Estimator, bool Media>
void share(Batch<N, Estimator, Media>& batch) {
  Sharing<N>& sharing = batch.sharing;
  for (const SecondVertex<N>& second : sharing.seconds) {
    if (!second.lambertian) batch.estimator.take(second.sample, second.tally, second.weight);
  }
  std::erase_if(sharing.seconds,
                [&](const SecondVertex<N>& second) { return !found_anything(batch, second); });
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
    if (second == begin) continue;
    share_block(batch, sharing.blocks[block], end,
                std::span<const SecondVertex<N>>(sharing.seconds).subspan(begin, second - begin));
  }
}

}  // namespace nocturne

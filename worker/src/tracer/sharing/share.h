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

#include "tracer/sharing/record_vertices.h"

namespace nocturne {

/// What a first vertex sees of some second ones.
struct Seen {
  /// Directions in the kernel's frame.
  SecondLanes::Floats x, y, z;
  /// Cosine of the direction at the first surface.
  SecondLanes::Floats cosine;
  /// From solid angle to area at the second vertex, 1/m2; not above zero where that shows its back.
  SecondLanes::Floats by_area;
};

/// In a loop without branches, which the compiler takes lanes together in.
template <int N>
Seen look(const FirstVertex<N>& first, const SecondLanes& lanes) {
  Seen seen;
  for (std::size_t i = 0; i < SecondLanes::kCount; ++i) {
    const Vec3 way = Vec3{lanes.x[i], lanes.y[i], lanes.z[i]} - first.hit.position;
    const float square = dot(way, way);
    const float inverse = 1.0f / std::sqrt(square);
    const Vec3 direction = inverse * way;
    const float cosine = -dot(Vec3{lanes.nx[i], lanes.ny[i], lanes.nz[i]}, direction);
    const float of_kernel = dot(Vec3{lanes.kx[i], lanes.ky[i], lanes.kz[i]}, direction);
    const Vec3 wi = first.frame.to_local(direction);
    seen.x[i] = wi.x, seen.y[i] = wi.y, seen.z[i] = wi.z;
    seen.cosine[i] = dot(first.normal, direction);
    const float by_area = cosine * inverse * inverse;
    const float facing = of_kernel < 0.0f ? by_area : 0.0f;
    seen.by_area[i] = square > 0.0f ? facing : 0.0f;
  }
  return seen;
}

/// What a photon from `first`, whose kernel is bound, brings from the second vertex `i` of those
/// that it sees if nothing is between. False where it would never go there.
template <int N, class Kernel>
bool meet(const FirstVertex<N>& first, const Kernel& kernel, const Seen& seen, std::size_t i,
          VertexConnection<N>& connection) {
  const float by_area = seen.by_area[i];
  const Vec3 wi{seen.x[i], seen.y[i], seen.z[i]};
  if (!(by_area > 0.0f) || !may_send(kernel, seen.cosine[i], wi)) return false;
  const Evaluation<N> there = evaluate<N>(kernel, first.wo, wi);
  connection.value = by_area * first.weight * there.value;
  // A photon that would carry nothing there ends.
  connection.density = only((first.survival * by_area) * there.pdf, alive(connection.value));
  return largest(connection.density) > 0.0f;
}

template <int N>
TimedRay way_between(const FirstVertex<N>& first, const SecondVertex<N>& second, float time) {
  const Vec3 towards = second.hit.position - first.hit.position;
  const Vec3 from = leave_surface(first.hit, towards), to = leave_surface(second.hit, -towards);
  const Vec3 way = to - from;
  const float distance = length(way);
  return {.ray = {from, (1.0f / distance) * way}, .time = time, .end = distance};
}

/// Of a first vertex with the second ones of some lanes, those from `begin` on.
template <int N, class Estimator, bool Media, class Kernel>
void find_meetings_of(Batch<N, Estimator, Media>& batch, std::uint32_t sample, const Kernel& kernel,
                      const SecondLanes& lanes, std::uint32_t begin,
                      std::span<const SecondVertex<N>> seconds) {
  const FirstVertex<N>& first = *batch.sharing.firsts[sample];
  const Seen seen = look(first, lanes);
  for (std::uint32_t i = 0; i < std::min(SecondLanes::kCount, seconds.size() - begin); ++i) {
    const std::uint32_t from = seconds[begin + i].sample;
    if (batch.sharing.firsts[from]->diffuse_like != first.diffuse_like) continue;
    VertexConnection<N> connection{
        .sample = sample, .second = begin + i, .value = 0.0f, .density = 0.0f};
    if (meet(first, kernel, seen, i, connection) || from == sample) {
      batch.sharing.block.add(connection);
    }
  }
}

/// All connections of a block, those of each second vertex together: the rays to it are close to
/// each other, and one packet follows them.
template <int N, class Estimator, bool Media>
void find_meetings(Batch<N, Estimator, Media>& batch, std::uint32_t first_sample,
                   std::uint32_t end_sample, std::span<const SecondVertex<N>> seconds) {
  BlockConnections<N>& block = batch.sharing.block;
  block.clear(seconds.size());
  std::vector<SecondLanes>& lanes = batch.sharing.lanes;
  lanes.assign((seconds.size() + SecondLanes::kCount - 1) / SecondLanes::kCount, {});
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    lanes[i / SecondLanes::kCount].set(i % SecondLanes::kCount, seconds[i]);
  }
  for (std::uint32_t sample = first_sample; sample < end_sample; ++sample) {
    const auto& first = batch.sharing.firsts[sample];
    if (!first) continue;
    visit_bound<N>(batch.scene.kernels, first->kernel, first->shading, [&](const auto& kernel) {
      for (std::uint32_t k = 0; k < lanes.size(); ++k) {
        find_meetings_of(batch, sample, kernel, lanes[k],
                         k * static_cast<std::uint32_t>(SecondLanes::kCount), seconds);
      }
    });
  }
  block.sort();
}

/// Leaves out the connections with something between.
template <int N, class Estimator, bool Media>
void keep_free(Batch<N, Estimator, Media>& batch, float time,
               std::span<const SecondVertex<N>> seconds) {
  std::vector<VertexConnection<N>>& connections = batch.sharing.block.sorted;
  const auto own = [&](const VertexConnection<N>& connection) {
    return seconds[connection.second].sample == connection.sample;
  };
  batch.timed_rays.clear();
  for (const VertexConnection<N>& connection : connections) {
    if (own(connection)) continue;
    const FirstVertex<N>& first = *batch.sharing.firsts[connection.sample];
    batch.timed_rays.push_back(way_between(first, seconds[connection.second], time));
  }
  batch.rays += batch.timed_rays.size();
  batch.blocked.resize(batch.timed_rays.size());
  batch.scene.geometry.occluded(batch.timed_rays, batch.blocked, RayCoherence::kCoherent);
  std::size_t ray = 0;
  std::erase_if(connections, [&](const VertexConnection<N>& connection) {
    return !own(connection) && batch.blocked[ray++] != 0;
  });
}

/// What a connection's first vertex has of the light that its second one sends.
template <int N>
Spectral<N> factor_of(const VertexConnection<N>& connection, const SecondVertex<N>& second,
                      const Spectral<N>& all) {
  // For the photon's own vertex, its weight is value over density already; and if that is rounded
  // to nothing, then no other photon takes it.
  const bool own = second.sample == connection.sample;
  return each(
      [own](float carried, float value, float mine, float sum) {
        if (!(carried > 0.0f)) return 0.0f;
        if (!(sum > 0.0f)) return own ? carried : 0.0f;
        return (own ? carried * mine : value) / sum;
      },
      second.weight, connection.value, connection.density, all);
}

/// Of one block: its samples, and the second vertices of these that found something.
template <int N, class Estimator, bool Media>
void share_block(Batch<N, Estimator, Media>& batch, std::uint32_t first_sample,
                 std::uint32_t end_sample, std::span<const SecondVertex<N>> seconds) {
  find_meetings(batch, first_sample, end_sample, seconds);
  keep_free(batch, batch.samples[first_sample].time, seconds);
  std::span<const VertexConnection<N>> left = batch.sharing.block.sorted;
  while (!left.empty()) {
    const std::uint32_t index = left.front().second;
    const SecondVertex<N>& second = seconds[index];
    Spectral<N> all = 0.0f;
    std::size_t count = 0;
    while (count < left.size() && left[count].second == index) all += left[count++].density;
    const std::span<const VertexConnection<N>> connections = left.first(count);
    left = left.subspan(count);
    for (const VertexConnection<N>& connection : connections) {
      batch.estimator.take(connection.sample, second.tally, factor_of(connection, second, all));
    }
  }
}

/// Those from which anything was found, by sample, otherwise in the order in which they were met.
template <int N, class Estimator, bool Media>
void sort_seconds(Batch<N, Estimator, Media>& batch) {
  Sharing<N>& sharing = batch.sharing;
  std::erase_if(sharing.seconds, [&](const SecondVertex<N>& second) {
    return !batch.estimator.found(second.tally);
  });
  sharing.ends.assign(batch.samples.size(), 0);
  for (const SecondVertex<N>& second : sharing.seconds) ++sharing.ends[second.sample];
  std::exclusive_scan(sharing.ends.begin(), sharing.ends.end(), sharing.ends.begin(), 0u);
  sharing.order.resize(sharing.seconds.size());
  for (std::uint32_t i = 0; i < sharing.seconds.size(); ++i) {
    sharing.order[sharing.ends[sharing.seconds[i].sample]++] = i;
  }
  sharing.found.clear();
  for (const std::uint32_t i : sharing.order) sharing.found.push_back(sharing.seconds[i]);
}

/// At the end of a batch, when the light found from each second vertex on is known: where that is
/// nothing, there is nothing to share.
template <int N, class Estimator, bool Media>
void share(Batch<N, Estimator, Media>& batch) {
  Sharing<N>& sharing = batch.sharing;
  sort_seconds(batch);
  std::size_t second = 0;
  for (std::size_t block = 0; block < sharing.blocks.size(); ++block) {
    const std::uint32_t end = block + 1 < sharing.blocks.size()
                                  ? sharing.blocks[block + 1]
                                  : static_cast<std::uint32_t>(batch.samples.size());
    const std::size_t begin = second;
    while (second < sharing.found.size() && sharing.found[second].sample < end) ++second;
    if (second == begin) continue;
    share_block(batch, sharing.blocks[block], end,
                std::span<const SecondVertex<N>>(sharing.found).subspan(begin, second - begin));
  }
}

}  // namespace nocturne

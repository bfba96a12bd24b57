// The light that neighbouring pixels share (docs/decisions/0061; Bekaert, Sbert and Halton,
// "Accelerating Path Tracing by Re-Using Paths", EGRW 2002). Each photon's first vertex x and
// second vertex y are kept; the radiance from y towards x is counted apart, and in the end every
// first vertex of the block takes it by its own kernel, weighted by the balance heuristic over all
// photons of the block that could have found y (Veach 1997).
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "tracer/vertex/vertex.h"

namespace nocturne {

/// A first vertex from which a photon goes on as others of its block might.
template <int N>
struct FirstVertex {
  Hit hit;
  Frame frame;
  Vec3 normal, wo;
  std::uint32_t kernel;
  Shading<N> shading;
  float survival;
  /// The weight that each photon carried there, weakened by the media it crossed.
  Spectral<N> weight;
  /// Of photons in both directions: what starts here may be a forward photon's.
  bool diffuse_like;
};

/// A diffuse surface that photons met next.
template <int N>
struct SecondVertex {
  std::uint32_t sample;
  /// The tally of the light that they find from there on, as of weight 1.
  std::uint32_t tally;
  /// What each carried there; zero for those that went elsewhere.
  Spectral<N> weight;
  Hit hit;
  /// The geometric normal on the side that they came from.
  Vec3 normal;
  /// Of the kernel's frame.
  Vec3 frame_normal;
};

/// Some second vertices side by side: a first vertex looks at all of them at once.
struct SecondLanes {
  static constexpr std::size_t kCount = 8;
  using Floats = std::array<float, kCount>;

  /// Positions, the normals of the surfaces and of the kernels; missing ones are zero.
  Floats x{}, y{}, z{}, nx{}, ny{}, nz{}, kx{}, ky{}, kz{};

  template <int N>
  void set(std::size_t i, const SecondVertex<N>& second) {
    const Vec3 p = second.hit.position, n = second.normal, k = second.frame_normal;
    x[i] = p.x, y[i] = p.y, z[i] = p.z;
    nx[i] = n.x, ny[i] = n.y, nz[i] = n.z;
    kx[i] = k.x, ky[i] = k.y, kz[i] = k.z;
  }
};

/// A first and a second vertex of a block.
template <int N>
struct VertexConnection {
  std::uint32_t sample, second;
  /// What the kernel of the first sends to the second, and the density with which its photon meets
  /// it, both by area there, 1/m2.
  Spectral<N> value, density;
};

/// Those of one block.
template <int N>
struct BlockConnections {
  std::vector<VertexConnection<N>> found, sorted;
  /// Of each second vertex: how many, and after `sort` where the next one's begin.
  std::vector<std::uint32_t> ends;

  void clear(std::size_t seconds) {
    found.clear();
    ends.assign(seconds, 0);
  }
  void add(const VertexConnection<N>& connection) {
    found.push_back(connection);
    ++ends[connection.second];
  }
  /// By second vertex, otherwise in the order in which they were added.
  void sort() {
    std::exclusive_scan(ends.begin(), ends.end(), ends.begin(), 0u);
    sorted.resize(found.size());
    for (const VertexConnection<N>& connection : found)
      sorted[ends[connection.second]++] = connection;
  }
};

template <int N>
struct Sharing {
  /// First sample of each block of the batch; empty where nothing is shared.
  std::vector<std::uint32_t> blocks;
  /// By sample. From the first vertex on a photon has its numbers from the block's sequence, as all
  /// of the block gain if they are spread evenly together.
  std::vector<PhotonSequence> sequences;
  std::vector<std::optional<FirstVertex<N>>> firsts;
  std::vector<SecondVertex<N>> seconds;
  /// Those from which anything was found, by sample, otherwise in the order in which they were met.
  std::vector<SecondVertex<N>> found;
  /// For sorting them: by sample, where its own end; and their indices in `seconds`.
  std::vector<std::uint32_t> ends, order;
  /// Of the block at hand.
  BlockConnections<N> block;
  std::vector<SecondLanes> lanes;

  bool on() const { return !blocks.empty(); }
  void clear() {
    blocks.clear();
    sequences.clear();
    firsts.clear();
    seconds.clear();
  }
};

}  // namespace nocturne

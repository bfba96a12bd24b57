// What neighbouring pixels share (docs/decisions/0061; Bekaert, Sbert and Halton, "Accelerating
// Path Tracing by Re-Using Paths", EGRW 2002). Each photon's first vertex x and second vertex y are
// kept; what comes from y towards x is counted apart, and in the end every first vertex of the
// block takes it by its own kernel, weighted by the balance heuristic over all photons of the block
// that could have found y (Veach 1997).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tracer/vertex.h"

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
  /// Of photons in both directions: what starts here may be a forward photon's.
  bool diffuse_like;
};

/// A surface that photons met next, and that sends the same to all sides.
template <int N>
struct SecondVertex {
  std::uint32_t sample;
  /// Where what they find from there on is counted, as of weight 1.
  std::uint32_t tally;
  /// What each carried there; zero for those that went elsewhere.
  Spectral<N> weight;
  Hit hit;
  /// On the side that they came from: the geometric normal, and that of the kernel.
  Vec3 normal, kernel_normal;
};

/// What a first vertex takes of a second one: `factor` times its tally.
template <int N>
struct Taken {
  std::uint32_t sample, tally;
  Spectral<N> factor;
};

/// A first and a second vertex of a block.
template <int N>
struct Meeting {
  std::uint32_t sample, second;
  /// What the kernel of the first sends to the second, and the density with which its photon meets
  /// it, both by area there, 1/m2.
  Spectral<N> value, density;
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
  std::vector<Taken<N>> taken;
  /// Of the block at hand.
  std::vector<Meeting<N>> meetings;
  std::vector<Spectral<N>> densities;

  bool on() const { return !blocks.empty(); }
  void clear() {
    blocks.clear();
    sequences.clear();
    firsts.clear();
    seconds.clear();
    taken.clear();
  }
};

}  // namespace nocturne

// Photons that follow a path together.
#pragma once

#include <cstdint>
#include <optional>

#include "luminaires/light_sampler.h"
#include "math/ray.h"
#include "sampling/sequence.h"
#include "scene/interior_list.h"
#include "spectrum/spectral.h"
#include "surfaces/departure.h"
#include "tracer/both_directions/path_partition.h"

namespace nocturne {

/// Which of the two techniques that sample a light drew a direction, as long as a light that is met
/// could have been found by both. The weights of both techniques add up to one.
enum class MisTechnique {
  kNone,
  /// Drawn by the kernel; the weight holds the division by its density.
  kKernel,
  /// Drawn towards lights; the weight holds no division yet.
  kLights,
};

/// The densities at the vertex where the direction was drawn. With photons in both directions the
/// context's position is known of all: that of the latest vertex that did not keep light together,
/// or where a photon left a luminaire.
template <int N>
struct MisState {
  MisTechnique technique = MisTechnique::kNone;
  LightSamplingContext context;
  Vec3 direction;
  /// Of the kernel, times the probability to survive, 1/sr.
  Spectral<N> kernel_pdf;
  /// Of kLights: as LightSampler drew it, 1/sr (DrawnDirection).
  float drawn_pdf = 0.0f;
  /// Of kLights: the largest weight that it left with, as it is outside of bodies.
  float worth = 1.0f;
};

/// How a group of photons starts.
template <int N>
struct Start {
  Ray ray;
  Departure departure = {};
  /// nm.
  Spectral<N> wavelengths;
  /// Bodies that it starts inside of.
  InteriorList inside;
  /// Of the shutter, [0, 1].
  float time = 0.0f;
  /// Footprint, for the sharpness of textures: width at the start, m, and growth per metre.
  float width = 0.0f, spread = 0.0f;
  /// Of the film that it starts from by the cosine; see SensorSample.
  std::optional<Vec3> film_normal = {};
  /// Of forward photons, W/nm; and whether they come from a distance that no scene has.
  Spectral<N> flux = 1.0f;
  bool distant = false;
  /// Of what emitted them.
  std::uint32_t light_group = 0;
};

template <int N>
struct Group {
  explicit Group(const PhotonSequence& numbers) : sequence(numbers) {}
  Group(const Start<N>& from, const PhotonSequence& numbers)
      : ray(from.ray),
        departure(from.departure),
        width(from.width),
        inside(from.inside),
        sequence(numbers) {}

  Ray ray;
  /// Where that starts exactly, near surfaces that are close together.
  Departure departure = {};
  /// Which of the batch's samples it belongs to.
  std::uint32_t sample = 0;
  /// Of the estimator, where the light it finds is counted: the sample's own, or a shared one.
  std::uint32_t tally = 0;
  /// Way from the last surface to where the ray starts, m; set inside of bodies only, and zero
  /// where the departure is exact.
  float ray_offset = 0.0f;
  /// From there to where the ray starts; set with it.
  Vec3 step = {0.0f, 0.0f, 0.0f};
  /// Width of the footprint, m.
  float width = 0.0f;
  /// The weight that each photon carries; zero for those that are gone or took another path.
  Spectral<N> weight = 1.0f;
  /// How likely each photon would have been to take the path so far, as media met and turned it by
  /// chance; relative, sum 1 over those that are there.
  Spectral<N> path_pdf_ratio = 1.0f / N;
  InteriorList inside;
  /// Interactions so far; those of them with media; those that let it straight through.
  std::uint32_t depth = 0, collisions = 0, passes = 0;
  /// Latest interactions in a row at which clear surfaces reflected or refracted it.
  std::uint32_t consecutive_specular = 0;
  /// Left a first vertex as its neighbours' photons might: the next surface may be shared.
  bool shares = false;
  /// Something else than mirrors and clear surfaces turned it.
  bool scattered = false;
  /// Of photons in both directions.
  PathEnds ends;
  MisState<N> mis;
  PhotonSequence sequence;
};

/// Whether photons from a camera see past a light that is hidden from it.
template <int N>
bool sees_past(const Group<N>& group, HiddenFrom hidden_from) {
  switch (hidden_from) {
    case HiddenFrom::kCamera:
      return group.depth == group.passes;
    case HiddenFrom::kCameraAndMirrors:
      return !group.scattered;
    case HiddenFrom::kNobody:
      break;
  }
  return false;
}

/// Whether light that it meets now is direct: its path has one interaction at most, and boundaries
/// that let it straight through. This is the light that a `max_depth` of 1 traces.
template <int N>
bool meets_direct_light(const Group<N>& group) {
  return group.depth - group.passes <= 1;
}

/// Bit i: photon i still carries something.
template <int N>
std::uint32_t alive(const Spectral<N>& weight) {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < N; ++i) mask |= weight[i] > 0.0f ? 1u << i : 0u;
  return mask;
}

/// The weights of those in `mask`, zero for the others.
template <int N>
Spectral<N> only(const Spectral<N>& weight, std::uint32_t mask) {
  Spectral<N> kept;
  for (std::size_t i = 0; i < N; ++i) kept[i] = (mask >> i) & 1u ? weight[i] : 0.0f;
  return kept;
}

/// a / b, and zero where b is.
template <int N>
Spectral<N> ratio(const Spectral<N>& a, const Spectral<N>& b) {
  const auto lanes = b.lanes;
  return Spectral<N>(lanes > 0.0f ? a.lanes / lanes : lanes - lanes);
}

}  // namespace nocturne

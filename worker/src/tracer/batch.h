// The photons that go through the stages together, and the state kept of each between two stages.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "tracer/group.h"
#include "tracer/kernel_order.h"
#include "tracer/media/free_flight.h"
#include "tracer/sharing/sharing.h"
#include "tracer/vertex/polarisation.h"
#include "tracer/vertex/vertex.h"

namespace nocturne {

/// Groups that are traced together unless a test wants it otherwise: enough of the same work for
/// every stage, and the state of each stays near the processor.
inline constexpr std::uint32_t kBatchGroups = 512;

/// Samples in a batch of so many groups. Where vertices split, a sample becomes many of them; those
/// that share stay together.
inline std::uint32_t samples_in_batch(const TracingOptions& options, std::uint32_t groups) {
  if (options.estimator != nocturne::Estimator::kSplit) return std::max(groups, options.sharing);
  std::uint32_t branches = 1;
  for (std::uint32_t i = 0; i < options.split_vertices; ++i) branches *= 3;
  return std::max(1u, groups / branches);
}

/// What all groups of one sample have in common, until photons change their wavelengths: those go
/// on as of another sample, and what they find counts for the first (Group::tally).
template <int N>
struct BatchSample {
  /// nm.
  Spectral<N> wavelengths;
  /// Of the shutter, [0, 1].
  float time;
  /// Growth of the footprint per metre.
  float spread;
  /// What a forward photon of weight 1 carries, W/nm.
  Spectral<N> flux;
  /// Of a forward photon.
  std::uint32_t light_group;
};

/// What else is known of a group at the end of its ray.
struct Encounter {
  /// The group ends here; nothing more is asked.
  bool ended = false;
  /// A forward photon that was connected to the camera on its path through thin media: the part
  /// that collides there is not connected again.
  bool connected_in_media = false;
  /// What touches the hit: index into Batch::contacts, or kNoContacts.
  std::uint32_t contacts = kNoContacts;

  static constexpr std::uint32_t kNoContacts = ~0u;
};

/// So many that the steps are worth a loop, so few that all of it stays near the processor.
inline constexpr std::size_t kChunk = 32;

template <int N, class Bound>
struct Chunk {
  std::size_t count = 0;
  std::array<Group<N>*, kChunk> groups;
  std::array<const Encounter*, kChunk> met;
  std::array<std::optional<Vertex<N>>, kChunk> vertices;
  std::array<std::optional<Bound>, kChunk> kernels;
  /// The next of each group.
  std::array<Uniform4, kChunk> numbers;
  std::array<float, kChunk> survival;
  /// A second photon goes towards lights.
  std::array<bool, kChunk> two_photons;
};

/// The light that is added to a tally if it is not occluded.
template <int N>
struct ShadowRay {
  TimedRay way;
  std::uint32_t tally;
  Spectral<N> light;
  /// See meets_direct_light.
  bool direct;
};

/// Of a shadow ray's light, that of one light group.
template <int N>
struct ShadowLight {
  std::size_t ray;
  std::uint32_t light_group;
  Spectral<N> light;
};

/// A forward photon that flies towards the camera.
template <int N>
struct CameraRay {
  Group<N> group;
  CameraConnection connection;
  /// Way that is left, m.
  float left;
  enum class State : std::uint8_t { kUnderWay, kHidden, kThere } state = State::kUnderWay;
};

/// Photons that a dye emitted where a group collided with a medium.
template <int N>
struct EmittedInMedium {
  Group<N> group;
  Hit hit;
};

/// Estimator counts the light or the sensors that photons meet; it has
///   kTransport
///   on_ray(sample, group, hit or null)  for every ray, before the body it crosses absorbs
///   on_surface(sample, group, hit)        for a surface that was met, after that
///   on_medium_emission(sample, group, hit)          for a medium, likewise
/// and, where forward photons are connected to the sensor,
///   connect(sample, place, u, v) and on_camera_connection(sample, group, connection).
template <int N, class Estimator, bool Media>
struct Batch {
  static constexpr Transport kTransport = Estimator::kTransport;
  static constexpr bool kAdjoint = kTransport == Transport::kAdjoint;
  static constexpr bool kPolarised = requires { requires Estimator::kPolarised; };
  static constexpr bool kToCamera = requires(Estimator & e, BatchSample<N> sample, Vec3 place) {
    e.connect(sample, place, 0.0f, 0.0f);
  };

  Batch(const Scene& traced, Estimator& counts, std::stop_token stop)
      : scene(traced),
        options(traced.options),
        both(traced.options.direction == Direction::kBoth),
        tells_groups(traced.wavelengths.light_groups() > 0),
        knows_ends(both || traced.options.gathered != TracingOptions::Gathered::kWithAll),
        shadow_rays_suffice(traced.shadow_rays_suffice &&
                            (traced.lights.learned().empty() || !traced.options.guide)),
        estimator(counts),
        limits(std::move(stop)) {}

  void clear() {
    limits.begin();
    samples.clear();
    flights.clear();
    groups.clear();
    sharing.clear();
    rays = 0;
  }

  /// Ends all groups of this wave.
  void truncate() {
    for (const Group<N>& group : groups) {
      limits.truncate(static_cast<std::uint32_t>(std::popcount(alive(group.weight))));
    }
    groups.clear();
  }

  const BatchSample<N>& sample_of(const Group<N>& group) const { return samples[group.sample]; }
  /// The group's photons have other wavelengths from now on. What `samples` held has moved.
  void change_wavelengths(Group<N>& group, const Spectral<N>& wavelengths) {
    const std::uint32_t before = group.sample;
    BatchSample<N> other = samples[before];
    other.wavelengths = wavelengths;
    group.sample = static_cast<std::uint32_t>(samples.size());
    samples.push_back(other);
    if constexpr (Media) flights.emplace_back(scene, wavelengths, limits);
    if constexpr (kPolarised) {
      Polarisation<N> same = estimator.polarisations()[before];
      same.flight = static_cast<std::uint32_t>(flights.size()) - 1;
      estimator.polarisations().push_back(same);
    }
  }
  /// Light is polarised otherwise from now on.
  void change_polarisation(Group<N>& group, const Polarisation<N>& polarisation) {
    const BatchSample<N> same = sample_of(group);
    group.sample = static_cast<std::uint32_t>(samples.size());
    samples.push_back(same);
    estimator.polarisations().push_back(polarisation);
  }
  FreeFlight<N>& flight_of(const Group<N>& group) {
    if constexpr (kPolarised) return flights[estimator.polarisations()[group.sample].flight];
    return flights[group.sample];
  }
  bool is_medium(const Hit& hit) const {
    if constexpr (Media) return scene.is_medium(hit.surface);
    return false;
  }

  const Scene& scene;
  const TracingOptions& options;
  const bool both;
  /// Light groups are kept separate.
  const bool tells_groups;
  /// Whether groups note their paths' ends.
  const bool knows_ends;
  /// Visibility of a light is the only question. Guided photons pass mirrors.
  const bool shadow_rays_suffice;
  Estimator& estimator;
  PathLimits limits;

  std::vector<BatchSample<N>> samples;
  /// By sample, where there are media.
  std::vector<FreeFlight<N>> flights;

  /// The groups of this wave, and what each meets; then those of the next wave.
  std::vector<Group<N>> groups, next;
  std::vector<TimedRay> timed_rays;
  std::vector<std::optional<Hit>> hits;
  std::vector<Encounter> encounters;
  std::vector<EmittedInMedium<N>> emitted;
  std::vector<Contacts> contacts;
  KernelOrder by_kernel;
  /// Of adjoint photons.
  Sharing<N> sharing;
  std::vector<ShadowRay<N>> shadow_rays;
  /// In their order, and only where light groups are kept separate.
  std::vector<ShadowLight<N>> shadow_lights;
  std::vector<std::uint8_t> blocked;
  std::vector<CameraRay<N>> camera_rays;
  std::vector<std::uint32_t> under_way;
  std::vector<std::optional<Hit>> camera_hits;
  std::uint64_t rays = 0;
};

}  // namespace nocturne

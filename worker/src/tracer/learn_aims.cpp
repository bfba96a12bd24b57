#include "tracer/learn_aims.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "math/functions.h"
#include "tracer/by_threads.h"
#include "tracer/estimators/camera_estimator.h"
#include "tracer/estimators/sensor_estimator.h"
#include "tracer/flush_denormals.h"
#include "tracer/photon_batches.h"
#include "tracer/photon_start.h"

namespace nocturne {
namespace {

/// Above 16 elements a direction's density takes a walk through a tree (luminaire_directions.h).
constexpr std::size_t kMaxAims = 16;
/// Places that make a ball; fewer are left to photons that are not aimed.
constexpr std::size_t kEnough = 16;
/// A ball is divided where that leaves so much of the cost, and loses at most one place of so
/// many.
constexpr double kWorthDividing = 0.8;
constexpr std::size_t kFew = 50;
/// Groups that one thread traces before it takes others.
constexpr std::uint64_t kChunk = 1u << 14;

using Places = std::vector<Vec3>;

std::array<double, 3> coordinates(Vec3 place) { return {place.x, place.y, place.z}; }

struct Cluster {
  Places places;
  std::array<double, 3> mean{};
  double radius = 0.0;
  std::size_t longest = 0;

  explicit Cluster(Places those) : places(std::move(those)) {
    if (places.empty()) return;
    std::array<double, 3> squares{};
    const auto count = static_cast<double>(places.size());
    for (const Vec3 place : places) {
      const auto at = coordinates(place);
      for (std::size_t i = 0; i < 3; ++i) {
        mean[i] += at[i] / count;
        squares[i] += at[i] * at[i] / count;
      }
    }
    radius = radius_of_most() * (1.0 + 1.0 / std::sqrt(count));  // few do not reach the edge
    for (std::size_t i = 0; i < 3; ++i) squares[i] -= mean[i] * mean[i];
    longest = static_cast<std::size_t>(std::ranges::max_element(squares) - squares.begin());
  }

  /// Neither too few places nor, but for rounding, all the same.
  bool good() const {
    constexpr double kRounding = 1e-6;
    return places.size() >= kEnough && radius > kRounding * math::hypot(mean[0], mean[1], mean[2]);
  }

  /// Photons that fall evenly on balls of areas A_i, n_i of them worth it, have the least variance
  /// if a part in proportion to the root of n_i A_i is sent to each; and it is the square of the
  /// sum of these roots.
  double cost() const { return std::sqrt(static_cast<double>(places.size())) * radius; }

  std::array<Cluster, 2> halves() const {
    Places lower, upper;
    for (const Vec3 place : places) {
      (coordinates(place)[longest] < mean[longest] ? lower : upper).push_back(place);
    }
    return {Cluster(std::move(lower)), Cluster(std::move(upper))};
  }

 private:
  /// Around the mean, without one place of a hundred: photons that are not aimed find those.
  double radius_of_most() const {
    std::vector<double> distances;
    for (const Vec3 place : places) {
      const auto at = coordinates(place);
      distances.push_back(math::hypot(at[0] - mean[0], at[1] - mean[1], at[2] - mean[2]));
    }
    const auto most =
        distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) * 99 / 100);
    std::ranges::nth_element(distances, most);
    return *most;
  }
};

/// Where a photon first came: a sensor on its way, or a surface.
template <int N>
std::optional<Vec3> first_place(const Scene& scene, Film film, const Start<N>& from) {
  const auto hit = scene.geometry.intersect(from.ray, from.time, from.departure);
  if (scene.sensor.splats_segments()) {
    const float way = hit ? hit->distance : std::numeric_limits<float>::infinity();
    const auto splat =
        scene.sensor.splat_segment(film, from.ray.origin, from.ray.direction, way, from.time);
    if (splat) return from.ray.origin + splat->distance * from.ray.direction;
  }
  if (!hit) return std::nullopt;
  return hit->position;
}

struct Chunk {
  Places places;
  TileSums counts{0, 0, 0};
};

template <int N, class Estimator, bool Media>
void trace_chunk(const Scene& scene, Film film, std::uint64_t first, std::uint64_t end,
                 Chunk& chunk) {
  const FlushDenormals flush;
  PhotonBatches<N, Estimator, Media> photons(scene, film, {});
  for (std::uint64_t begin = first; begin < end; begin += kBatchGroups) {
    photons.trace(begin, std::min<std::uint64_t>(kBatchGroups, end - begin), chunk.counts);
    std::optional<std::uint32_t> latest;
    for (const Splat<N>& splat : photons.splats()) {
      if (latest == splat.sample || !(largest(splat.value) > 0.0f)) continue;
      latest = splat.sample;
      const std::uint64_t photon = begin + splat.sample;
      PixelSequence numbers = photon_numbers(scene, photon);
      PhotonSequence sequence(numbers, sample_of_photon(photon));
      const PhotonStart<N> from = start_photon<N>(scene, sequence);
      if (!from.from_surface) continue;
      if (const auto place = first_place(scene, film, from.start)) chunk.places.push_back(*place);
    }
  }
  chunk.counts.photons = (end - first) * N;
}

template <int N>
void trace_group(const Scene& scene, Film film, std::uint64_t first, std::uint64_t end,
                 Chunk& chunk) {
  const auto trace = [&]<class Estimator>() {
    scene.media.empty() ? trace_chunk<N, Estimator, false>(scene, film, first, end, chunk)
                        : trace_chunk<N, Estimator, true>(scene, film, first, end, chunk);
  };
  scene.options.direction == Direction::kForward ? trace.template operator()<SensorEstimator<N>>()
                                                 : trace.template operator()<CameraEstimator<N>>();
}

void trace_any(const Scene& scene, Film film, std::uint64_t first, std::uint64_t end,
               Chunk& chunk) {
  switch (scene.options.group) {
    case 4:
      return trace_group<4>(scene, film, first, end, chunk);
    default:
      return trace_group<1>(scene, film, first, end, chunk);
  }
}

}  // namespace

std::vector<Aim> aims_around(const Places& places) {
  std::vector<Cluster> clusters{Cluster(places)};
  // One that is not worth dividing stays; those that came of another are looked at, too.
  for (std::size_t i = 0; i < clusters.size() && clusters.size() < kMaxAims;) {
    auto [larger, smaller] = clusters[i].halves();
    if (larger.places.size() < smaller.places.size()) std::swap(larger, smaller);
    const bool both = smaller.good();
    const double cost = larger.cost() + (both ? smaller.cost() : 0.0);
    const bool may_divide = larger.good() && (both || smaller.places.size() * kFew < places.size());
    if (!may_divide || !(cost < kWorthDividing * clusters[i].cost())) {
      ++i;
      continue;
    }
    clusters[i] = std::move(larger);
    if (both) clusters.push_back(std::move(smaller));
  }
  std::vector<Aim> aims;
  for (const Cluster& cluster : clusters) {
    if (!cluster.good()) continue;  // the first, where all came to one point
    aims.push_back({{static_cast<float>(cluster.mean[0]), static_cast<float>(cluster.mean[1]),
                     static_cast<float>(cluster.mean[2])},
                    static_cast<float>(cluster.radius),
                    cluster.cost()});
  }
  return aims;
}

LearnedAims learn_aims(Scene& scene, Film film, double photons, unsigned threads) {
  if (scene.options.direction != Direction::kForward && !scene.has_mirrors) return {};
  const TracingOptions before = scene.options;
  scene.options.aimed_emission = 0.0f;
  scene.options.seed = ~before.seed;
  const auto all = static_cast<std::uint64_t>(std::max(1.0, photons));
  std::vector<Chunk> chunks((all + kChunk - 1) / kChunk);
  by_threads(chunks.size(), threads, [&](std::size_t i) {
    trace_any(scene, film, i * kChunk, std::min(all, (i + 1) * kChunk), chunks[i]);
  });
  scene.options = before;
  LearnedAims found{};
  Places places;
  for (const Chunk& chunk : chunks) {
    places.insert(places.end(), chunk.places.begin(), chunk.places.end());
    found.photons += chunk.counts.photons;
    found.rays += chunk.counts.rays;
  }
  if (places.size() >= kEnough) found.aims = aims_around(places);
  return found;
}

}  // namespace nocturne

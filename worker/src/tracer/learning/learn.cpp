#include "tracer/learning/learn.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <type_traits>

#include "scene/sensor_extents.h"
#include "tracer/by_kind.h"
#include "tracer/by_threads.h"
#include "tracer/estimators/arrival_estimator.h"
#include "tracer/estimators/sensor_estimator.h"
#include "tracer/flush_denormals.h"
#include "tracer/photon_batches.h"
#include "tracer/photon_start.h"

namespace nocturne {
namespace {

/// Groups that one thread traces before it takes others.
constexpr std::uint64_t kPhotonsAtOnce = 1u << 14;

/// Where a photon first came: a sensor on its path, or a surface.
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

template <int N, class Estimator, bool Media>
Learned learn_chunk(const Scene& scene, Film film, std::uint64_t first, std::uint64_t end) {
  const FlushDenormals flush;
  Learned found;
  TileSums counts{0, 0, 0};
  PhotonBatches<N, Estimator, Media> photons(scene, film, {});
  const Geometry::Ball lit = ball_with_film(scene, film);
  for (std::uint64_t begin = first; begin < end; begin += kBatchGroups) {
    photons.trace(begin, std::min<std::uint64_t>(kBatchGroups, end - begin), counts);
    std::optional<std::uint32_t> latest;
    for (const Splat<N>& splat : photons.splats()) {
      if (latest == splat.sample || !(largest(splat.value) > 0.0f)) continue;
      latest = splat.sample;
      const std::uint64_t photon = begin + splat.sample;
      PixelSequence numbers = photon_numbers(scene, photon);
      PhotonSequence sequence(numbers, sample_of_photon(photon));
      const PhotonStart<N> from = start_photon<N>(scene, lit, sequence);
      const auto place = first_place(scene, film, from.start);
      if (place) found.worth_aiming_at.push_back(*place);
    }
  }
  if constexpr (std::is_same_v<Estimator, ArrivalEstimator<N>>) {
    found.arrivals = photons.estimator().arrivals();
  }
  found.photons = (end - first) * N;
  found.rays = counts.rays;
  return found;
}

}  // namespace

Learned learn(Scene& scene, Film film, double photons, unsigned threads) {
  const Direction direction = scene.options.direction;
  if (direction == Direction::kAdjoint) return {};
  if (direction == Direction::kBoth && !scene.has_mirrors) return {};
  const TracingOptions before = scene.options;
  // A person has photons aimed at the things that the camera looks at: the things it sees in
  // mirrors lie elsewhere.
  scene.options.aimed_emission = 0.0f;
  scene.options.seed = ~before.seed;
  const auto all = static_cast<std::uint64_t>(std::max(1.0, photons));
  std::vector<Learned> chunks((all + kPhotonsAtOnce - 1) / kPhotonsAtOnce);
  by_threads(chunks.size(), threads, [&](std::size_t i) {
    const std::uint64_t first = i * kPhotonsAtOnce, end = std::min(all, first + kPhotonsAtOnce);
    chunks[i] = by_kind_of(scene, [&]<int N, bool Media>() {
      return direction == Direction::kForward
                 ? learn_chunk<N, SensorEstimator<N>, Media>(scene, film, first, end)
                 : learn_chunk<N, ArrivalEstimator<N>, Media>(scene, film, first, end);
    });
  });
  scene.options = before;
  Learned found;
  std::vector<LearnedLight::Arrival> arrivals;
  for (const Learned& chunk : chunks) {
    found.worth_aiming_at.insert(found.worth_aiming_at.end(), chunk.worth_aiming_at.begin(),
                                 chunk.worth_aiming_at.end());
    arrivals.insert(arrivals.end(), chunk.arrivals.begin(), chunk.arrivals.end());
    found.photons += chunk.photons;
    found.rays += chunk.rays;
  }
  const std::size_t step = arrivals.size() / LearnedLight::kMaxArrivals + 1;
  for (std::size_t i = 0; i < arrivals.size(); i += step) found.arrivals.push_back(arrivals[i]);
  return found;
}

}  // namespace nocturne

#include "tracer/learn_light.h"

#include <algorithm>

#include "tracer/by_threads.h"
#include "tracer/flush_denormals.h"
#include "tracer/photon_start.h"
#include "tracer/trace_batch.h"

namespace nocturne {
namespace {

/// Groups that one thread traces before it takes others.
constexpr std::uint64_t kPart = 1u << 14;

/// Keeps where forward photons come to what is like a diffuse surface.
template <int N>
class ArrivalEstimator {
 public:
  static constexpr Transport kTransport = Transport::kForward;

  explicit ArrivalEstimator(const Scene& scene) : scene_(scene) {}

  void flies(const BatchSample<N>&, const Group<N>&, const Hit*) {}
  void glows(const BatchSample<N>&, const Group<N>&, const Hit&) {}
  void arrives(const BatchSample<N>&, const Group<N>& group, const Hit& hit) {
    const SurfaceMaterial& material = scene_.materials[hit.surface];
    if (!group.ends.specular_like_at_luminaire || group.scattered || material.may_pass) return;
    if (scene_.specular_like[kernel_at(scene_, hit, group.ray.direction)]) return;
    arrivals.push_back({hit.position, -group.ray.direction});
  }

  std::vector<LearnedLight::Arrival> arrivals;

 private:
  const Scene& scene_;
};

struct Part {
  std::vector<LearnedLight::Arrival> arrivals;
  std::uint64_t photons = 0, rays = 0;
};

template <int N, bool Media>
void trace_chunk(const Scene& scene, std::uint64_t first, std::uint64_t end, Part& chunk) {
  const FlushDenormals flush;
  ArrivalEstimator<N> estimator(scene);
  Batch<N, ArrivalEstimator<N>, Media> batch(scene, estimator, {});
  for (std::uint64_t begin = first; begin < end; begin += kBatchGroups) {
    batch.clear();
    const std::uint64_t stop = std::min(end, begin + kBatchGroups);
    PixelSequence numbers = photon_numbers(scene, begin);
    for (std::uint64_t photon = begin; photon < stop; ++photon) {
      PhotonSequence sequence(numbers, sample_of_photon(photon));
      start(batch, start_photon<N>(scene, sequence).start, sequence);
    }
    trace_batch(batch);
    chunk.rays += batch.rays;
  }
  chunk.photons = (end - first) * N;
  chunk.arrivals = std::move(estimator.arrivals);
}

void trace_any(const Scene& scene, std::uint64_t first, std::uint64_t end, Part& chunk) {
  const auto trace = [&]<int N>() {
    scene.media.empty() ? trace_chunk<N, false>(scene, first, end, chunk)
                        : trace_chunk<N, true>(scene, first, end, chunk);
  };
  scene.options.group == 4 ? trace.template operator()<4>() : trace.template operator()<1>();
}

}  // namespace

LearnedArrivals learn_light(Scene& scene, double photons, std::size_t most, unsigned threads) {
  if (scene.options.direction != Direction::kBoth || !scene.has_mirrors) return {};
  const TracingOptions before = scene.options;
  scene.options.seed = ~before.seed;
  // What these are aimed at is where the camera sees them: what it sees in mirrors lies elsewhere.
  scene.options.aimed_emission = 0.0f;
  const auto all = static_cast<std::uint64_t>(std::max(1.0, photons));
  std::vector<Part> chunks((all + kPart - 1) / kPart);
  by_threads(chunks.size(), threads, [&](std::size_t i) {
    trace_any(scene, i * kPart, std::min(all, (i + 1) * kPart), chunks[i]);
  });
  scene.options = before;
  LearnedArrivals found{};
  std::vector<LearnedLight::Arrival> everywhere;
  for (const Part& chunk : chunks) {
    everywhere.insert(everywhere.end(), chunk.arrivals.begin(), chunk.arrivals.end());
    found.photons += chunk.photons;
    found.rays += chunk.rays;
  }
  const std::size_t step = (everywhere.size() + most - 1) / std::max<std::size_t>(1, most);
  for (std::size_t i = 0; i < everywhere.size(); i += std::max<std::size_t>(1, step)) {
    found.arrivals.push_back(everywhere[i]);
  }
  return found;
}

}  // namespace nocturne

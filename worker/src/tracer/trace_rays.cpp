#include "tracer/trace_rays.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "tracer/by_kind.h"
#include "tracer/by_threads.h"
#include "tracer/estimators/leaving_estimator.h"
#include "tracer/flush_denormals.h"
#include "tracer/photon_batches.h"

namespace nocturne {
namespace {

// Photons of a piece of work, and pieces that are held before they are handed on.
constexpr std::uint64_t kPiece = 1 << 15;
constexpr std::size_t kPiecesPerThread = 4;

std::vector<LeavingRay> piece(const Scene& scene, std::uint64_t first, std::uint64_t end) {
  const FlushDenormals flush;
  return by_kind_of(scene, [&]<int N, bool Media>() {
    const auto batch = samples_in_batch(scene.options, kBatchGroups);
    PhotonBatches<N, LeavingEstimator<N>, Media> photons(scene, {1, 1}, {});
    TileSums counts(1, 1, 0);
    for (std::uint64_t photon = first; photon < end; photon += batch) {
      photons.trace(photon, std::min<std::uint64_t>(batch, end - photon), counts);
    }
    return std::move(photons.estimator().rays());
  });
}

}  // namespace

void trace_rays(const Scene& scene, std::uint64_t photons, unsigned threads,
                const std::function<void(std::span<const LeavingRay>)>& take) {
  if (scene.options.direction != Direction::kForward || !scene.sensor.receives_escapes()) {
    throw std::invalid_argument("rays of a scene without forward photons or an intensity meter");
  }
  const auto at_once = std::size_t{threads} * kPiecesPerThread;
  const float part = 1.0f / static_cast<float>(photons);
  for (std::uint64_t first = 0; first < photons; first += at_once * kPiece) {
    const std::uint64_t left = photons - first;
    const auto count = std::min<std::size_t>(at_once, (left + kPiece - 1) / kPiece);
    std::vector<std::vector<LeavingRay>> pieces(count);
    by_threads(count, threads, [&](std::size_t i) {
      const std::uint64_t from = first + i * kPiece;
      pieces[i] = piece(scene, from, std::min(from + kPiece, photons));
    });
    for (std::vector<LeavingRay>& each : pieces) {
      for (LeavingRay& ray : each) ray.watts *= part;
      take(each);
    }
  }
}

}  // namespace nocturne

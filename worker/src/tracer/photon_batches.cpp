#include "tracer/photon_batches.h"

#include "tracer/estimators/camera_estimator.h"
#include "tracer/estimators/sensor_estimator.h"
#include "tracer/response.h"
#include "tracer/trace_batch.h"

namespace nocturne {
namespace {

// Where a photon starts; with weight 0 where none is emitted.
template <int N>
Start<N> emit(const Scene& scene, float time, const Spectral<N>& wavelengths_nm,
              PhotonSequence& sequence) {
  const Uniform4 first = sequence.next(), second = sequence.next();
  const auto emitted =
      scene.emitter.emit(scene.luminaires, scene.lights, scene.geometry,
                         scene.options.aimed_emission, time, wavelengths_nm, first, second);
  if (!emitted) return {.ray = {}, .wavelengths = wavelengths_nm, .inside = {}, .flux = 0.0f};
  Start<N> start{.ray = emitted->ray,
                 .departure = emitted->departure,
                 .wavelengths = wavelengths_nm,
                 .inside = {},
                 .time = time};
  if (emitted->luminaire != Emitted<N>::kDistant) {
    start.inside = scene.luminaires_inside[emitted->luminaire];
  }
  start.flux = emitted->flux;
  return start;
}

}  // namespace

template <int N, class Estimator, bool Media>
PhotonBatches<N, Estimator, Media>::PhotonBatches(const Scene& scene, Film film, std::uint32_t most,
                                                  const std::stop_token& stop)
    : scene_(scene),
      scale_(1.0 / (film.width * film.height)),
      estimator_(scene, film),
      batch_(scene, estimator_, stop) {
  sequences_.reserve(most);  // groups point to them
}

template <int N, class Estimator, bool Media>
void PhotonBatches<N, Estimator, Media>::trace(std::span<const PhotonIndex> photons,
                                               TileSums& counts) {
  batch_.clear();
  wavelengths_.clear();
  sequences_.clear();
  estimator_.splats().clear();
  // With both directions, other numbers than those of photons from the pixels.
  const std::uint32_t other = scene_.options.direction == Direction::kBoth ? ~0u : 0u;
  for (const PhotonIndex& photon : photons) {
    sequences_.emplace_back(scene_.options.sequence, scene_.options.seed, photon.number ^ other);
    PhotonSequence sequence(sequences_.back(), photon.sample);
    const Uniform4 u = sequence.next();
    wavelengths_.push_back(scene_.wavelengths.template sample<N>(u[2]));
    const auto from = emit<N>(scene_, u[3], wavelengths_.back().nm, sequence);
    start(batch_, from, sequence);
  }
  trace_batch(batch_);
  counts.rays += batch_.rays;
  counts.truncated_paths += batch_.limits.truncated();
  sort_by_sample(estimator_.splats());
}

template <int N, class Estimator, bool Media>
std::uint32_t PhotonBatches<N, Estimator, Media>::add(const Splat<N>& splat, double* values) const {
  const Response<N> response(scene_.wavelengths, wavelengths_[splat.sample]);
  return response.add(splat.value, scale_, values);
}

template class PhotonBatches<1, SensorEstimator<1>, false>;
template class PhotonBatches<1, SensorEstimator<1>, true>;
template class PhotonBatches<4, SensorEstimator<4>, false>;
template class PhotonBatches<4, SensorEstimator<4>, true>;
template class PhotonBatches<8, SensorEstimator<8>, false>;
template class PhotonBatches<8, SensorEstimator<8>, true>;
template class PhotonBatches<1, CameraEstimator<1>, false>;
template class PhotonBatches<1, CameraEstimator<1>, true>;
template class PhotonBatches<4, CameraEstimator<4>, false>;
template class PhotonBatches<4, CameraEstimator<4>, true>;
template class PhotonBatches<8, CameraEstimator<8>, false>;
template class PhotonBatches<8, CameraEstimator<8>, true>;

}  // namespace nocturne

#include "tracer/photon_batches.h"

#include "scene/sensor_extents.h"
#include "tracer/estimators/arrival_estimator.h"
#include "tracer/estimators/camera_estimator.h"
#include "tracer/estimators/leaving_estimator.h"
#include "tracer/estimators/sensor_estimator.h"
#include "tracer/photon_loop.h"
#include "tracer/photon_start.h"
#include "tracer/response.h"

namespace nocturne {

template <int N, class Estimator, bool Media>
PhotonBatches<N, Estimator, Media>::PhotonBatches(const Scene& scene, Film film,
                                                  const std::stop_token& stop)
    : scene_(scene),
      lit_(ball_with_film(scene, film)),
      scale_(1.0 / (film.width * film.height)),
      estimator_(scene, film),
      batch_(scene, estimator_, stop) {
  numbers_.reserve(2);  // groups point to them
}

template <int N, class Estimator, bool Media>
void PhotonBatches<N, Estimator, Media>::trace(std::uint64_t first, std::size_t count,
                                               TileSums& counts) {
  batch_.clear();
  wavelengths_.clear();
  numbers_.clear();
  estimator_.splats().clear();
  for (std::uint64_t photon = first; photon < first + count; ++photon) {
    if (numbers_.empty() || sample_of_photon(photon) == 0) {
      numbers_.push_back(photon_numbers(scene_, photon));
    }
    PhotonSequence sequence(numbers_.back(), sample_of_photon(photon));
    const PhotonStart<N> from = start_photon<N>(scene_, lit_, sequence);
    wavelengths_.push_back(from.wavelengths);
    start(batch_, from.start, sequence);
  }
  trace_batch(batch_);
  counts.rays += batch_.rays;
  counts.truncated_paths += batch_.limits.truncated();
  sort_by_sample(estimator_.splats());
}

template <int N, class Estimator, bool Media>
std::uint32_t PhotonBatches<N, Estimator, Media>::add(const Splat<N>& splat, double* values) const {
  const Response<N> response(scene_.wavelengths, wavelengths_[splat.sample]);
  const auto part_of = [&](const CountedLight& light) {
    const bool counts = light.group ? *light.group == splat.light_group : splat.direct;
    return counts ? splat.value : Spectral<N>(0.0f);
  };
  return response.add(splat.value, part_of, scale_, values);
}

template class PhotonBatches<1, SensorEstimator<1>, false>;
template class PhotonBatches<1, SensorEstimator<1>, true>;
template class PhotonBatches<4, SensorEstimator<4>, false>;
template class PhotonBatches<4, SensorEstimator<4>, true>;
template class PhotonBatches<1, CameraEstimator<1>, false>;
template class PhotonBatches<1, CameraEstimator<1>, true>;
template class PhotonBatches<4, CameraEstimator<4>, false>;
template class PhotonBatches<4, CameraEstimator<4>, true>;
template class PhotonBatches<1, ArrivalEstimator<1>, false>;
template class PhotonBatches<1, ArrivalEstimator<1>, true>;
template class PhotonBatches<4, ArrivalEstimator<4>, false>;
template class PhotonBatches<4, ArrivalEstimator<4>, true>;
template class PhotonBatches<1, LeavingEstimator<1>, false>;
template class PhotonBatches<1, LeavingEstimator<1>, true>;
template class PhotonBatches<4, LeavingEstimator<4>, false>;
template class PhotonBatches<4, LeavingEstimator<4>, true>;

}  // namespace nocturne

#include "tracer/pixel_batches.h"

#include "math/in_place.h"
#include "tracer/response.h"
#include "tracer/trace_batch.h"

namespace nocturne {

template <int N, bool Media>
PixelBatches<N, Media>::PixelBatches(const Scene& scene, Film film, std::uint32_t most,
                                     const std::stop_token& stop)
    : scene_(scene), film_(film), estimator_(scene), batch_(scene, estimator_, stop) {
  sequences_.reserve(most);  // groups point to them
}

template <int N, bool Media>
void PixelBatches<N, Media>::trace(std::span<const PixelIndex> samples, TileSums& counts,
                                   double* values) {
  batch_.clear();
  samples_.clear();
  sequences_.clear();
  estimator_.reset(samples.size());
  std::uint32_t last = ~0u;
  for (const PixelIndex& at : samples) {
    const std::uint32_t pixel = at.y * film_.width + at.x;
    if (pixel != last) {
      sequences_.emplace_back(scene_.options.sequence, scene_.options.seed, pixel);
      last = pixel;
    }
    PhotonSequence sequence(sequences_.back(), at.sample);
    samples_.emplace_back(
        InPlace{[&] { return sample_pixel<N>(scene_, film_, at.x, at.y, sequence); }});
    start(batch_, samples_.back().start, sequence);
  }
  trace_batch(batch_);
  counts.rays += batch_.rays;
  counts.truncated_paths += batch_.limits.truncated();
  for (std::size_t i = 0; i < samples.size(); ++i, values += counts.values()) {
    const Response<N> response(scene_.wavelengths, samples_[i].wavelengths);
    counts.invalid_samples += response.add(estimator_.radiance(i), samples_[i].weight, values);
  }
}

template class PixelBatches<1, false>;
template class PixelBatches<1, true>;
template class PixelBatches<4, false>;
template class PixelBatches<4, true>;
template class PixelBatches<8, false>;
template class PixelBatches<8, true>;

}  // namespace nocturne

#include "tracer/trace_daylight.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "math/frame.h"
#include "math/in_place.h"
#include "tracer/by_kind.h"
#include "tracer/by_threads.h"
#include "tracer/estimators/sky_estimator.h"
#include "tracer/flush_denormals.h"
#include "tracer/joint_sets.h"
#include "tracer/photon_loop.h"
#include "tracer/pixel_sample.h"

namespace nocturne {
namespace {

/// Of one pixel at a time: its sums come in the order of its samples, whatever the threads.
template <int N, bool Media>
class DaylightPixel {
 public:
  DaylightPixel(const Scene& scene, const DaylightRequest& request)
      : scene_(scene),
        request_(request),
        size_(samples_in_batch(scene.options, kBatchGroups)),
        of_sky_(scene, false),
        of_suns_(scene, true),
        sky_batch_(scene, of_sky_, {}),
        sun_batch_(scene, of_suns_, {}) {}

  void trace(std::uint32_t pixel, DaylightSums& counts, DaylightSums& sums) {
    PixelSequence numbers(scene_.options.sequence, scene_.options.seed, pixel,
                          joint_sets_of_pixel(sets_of_pixel(scene_), scene_.sensor.aims()));
    for (std::uint32_t first = request_.first_sample; first < request_.end_sample; first += size_) {
      trace_sky(numbers, pixel, first, std::min(first + size_, request_.end_sample), counts, sums);
    }
    if (request_.suns.empty()) return;
    for (std::uint32_t i = request_.first_sample; i < request_.end_sample; ++i) {
      trace_suns(numbers, pixel, i, counts, sums);
    }
  }

 private:
  PixelSample<N> sample_at(std::uint32_t pixel, PhotonSequence& sequence) const {
    const PixelNumbers numbers = next_pixel_numbers(scene_, sequence);
    const Film film = request_.film;
    return sample_pixel<N>(scene_, film, pixel % film.width, pixel / film.width, numbers);
  }

  void trace_sky(PixelSequence& numbers, std::uint32_t pixel, std::uint32_t first,
                 std::uint32_t end, DaylightSums& counts, DaylightSums& sums) {
    sky_batch_.clear();
    of_sky_.reset(end - first);
    of_sky_.met().clear();
    samples_.clear();
    for (std::uint32_t i = first; i < end; ++i) {
      PhotonSequence sequence(numbers, i);
      samples_.emplace_back(InPlace{[&] { return sample_at(pixel, sequence); }});
      start(sky_batch_, samples_.back().start, sequence);
    }
    finish(sky_batch_, of_sky_, samples_.size(), counts);
    const std::size_t count = request_.patches.count();
    for (const auto& met : of_sky_.met()) {
      const PixelSample<N>& sample = samples_[met.tally];
      const double value = sample.weight * luminous(sample.wavelengths, met.light, counts);
      const std::size_t part = std::size_t{pixel} * 2 + (met.straight ? 0 : 1);
      sums.patches[part * count + request_.patches.number(met.direction)] += value;
    }
  }

  /// One photon to each sun, from the same place and with the same wavelengths.
  void trace_suns(PixelSequence& numbers, std::uint32_t pixel, std::uint32_t index,
                  DaylightSums& counts, DaylightSums& sums) {
    PhotonSequence sequence(numbers, index);
    PixelSample<N> sample = sample_at(pixel, sequence);
    const Uniform4 u = sequence.next();
    const Vec3 normal = *sample.start.film_normal;
    sample.start.film_normal.reset();
    const Spectral<N> white = scene_.distant_radiance(request_.suns.front(), sample.wavelengths.nm);
    const double across = luminous(sample.wavelengths, white, counts);
    sums.across[pixel] += across;
    const float radius = request_.sun_radius * std::sqrt(u[0]);
    const float x = radius * math::cos(kTwoPi * u[1]), y = radius * math::sin(kTwoPi * u[1]);
    const std::size_t suns = request_.suns.size();
    for (std::size_t first = 0; first < suns; first += size_) {
      const std::size_t end = std::min<std::size_t>(first + size_, suns);
      sun_batch_.clear();
      of_suns_.reset(end - first);
      of_suns_.met().clear();
      which_.clear();
      for (std::size_t i = first; i < end; ++i) {
        const Vec3 direction = normalized(Frame(request_.suns[i]).to_world({x, y, 1.0f}));
        const float cosine = dot(normal, direction);
        if (!(cosine > 0.0f)) continue;
        which_.push_back({i, cosine});
        sample.start.ray.direction = direction;
        start(sun_batch_, sample.start, sequence);
        Group<N>& group = sun_batch_.groups.back();
        group.mis.technique = MisTechnique::kLights;
        group.mis.direction = direction;
        group.mis.worth = worth_outside(sun_batch_, group);
      }
      finish(sun_batch_, of_suns_, which_.size(), counts);
      for (const auto& met : of_suns_.met()) {
        const auto [sun, cosine] = which_[met.tally];
        const double value = luminous(sample.wavelengths, met.light * white, counts);
        sums.suns[std::size_t{pixel} * suns + sun] += sample.weight / kPi * cosine * value;
      }
    }
  }

  template <class Batch>
  void finish(Batch& batch, SkyEstimator<N>& estimator, std::size_t samples, DaylightSums& counts) {
    trace_batch(batch);
    // Of one sample in the order in which they were met, which does not depend on the others.
    std::ranges::stable_sort(estimator.met(), {}, &SkyEstimator<N>::Met::tally);
    counts.photons += samples * N;
    counts.rays += batch.rays;
    counts.truncated_paths += batch.limits.truncated();
  }

  /// The mean over a group's photons of Y's response x light.
  double luminous(const WavelengthSamples<N>& wavelengths, const Spectral<N>& light,
                  DaylightSums& counts) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < N; ++k) {
      if (std::isfinite(light[k]) && light[k] >= 0.0f) {
        sum += static_cast<double>(wavelengths.weight[1][k]) * light[k];
      } else {
        ++counts.invalid_samples;
      }
    }
    return sum / N;
  }

  struct SunRay {
    std::size_t sun;
    float cosine;
  };

  const Scene& scene_;
  const DaylightRequest& request_;
  const std::uint32_t size_;
  SkyEstimator<N> of_sky_, of_suns_;
  Batch<N, SkyEstimator<N>, Media> sky_batch_, sun_batch_;
  std::vector<PixelSample<N>> samples_;
  std::vector<SunRay> which_;
};

/// Pixels of a piece of work.
constexpr std::uint32_t kPiece = 16;

}  // namespace

DaylightSums trace_daylight(Scene& scene, const DaylightRequest& request, unsigned threads,
                            const std::function<void(double)>& progress) {
  if (!scene.sensor.aims() || scene.options.direction != Direction::kAdjoint) {
    throw std::invalid_argument("daylight is of meters, by photons from these alone");
  }
  if (!scene.lights.environment()) throw std::invalid_argument("a scene without a sky");
  scene.options.sharing = 1;
  // Photons that fly towards lights tell what they meet.
  scene.shadow_rays_suffice = false;
  const std::uint32_t pixels = request.film.width * request.film.height;
  DaylightSums sums{
      .patches = std::vector<double>(std::size_t{pixels} * 2 * request.patches.count()),
      .suns = std::vector<double>(pixels * request.suns.size()),
      .across = std::vector<double>(pixels)};
  std::mutex mutex;
  std::uint32_t done = 0;
  by_threads((pixels + kPiece - 1) / kPiece, threads, [&](std::size_t piece) {
    const FlushDenormals flush;
    const auto first = static_cast<std::uint32_t>(piece) * kPiece;
    const std::uint32_t end = std::min(first + kPiece, pixels);
    DaylightSums counts;
    by_kind_of(scene, [&]<int N, bool Media>() {
      DaylightPixel<N, Media> pixel(scene, request);
      for (std::uint32_t i = first; i < end; ++i) pixel.trace(i, counts, sums);
    });
    const std::lock_guard lock(mutex);
    sums.photons += counts.photons;
    sums.rays += counts.rays;
    sums.invalid_samples += counts.invalid_samples;
    sums.truncated_paths += counts.truncated_paths;
    progress(static_cast<double>(done += end - first) / pixels);
  });
  return sums;
}

}  // namespace nocturne

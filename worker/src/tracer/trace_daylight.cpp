#include "tracer/trace_daylight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "math/frame.h"
#include "math/in_place.h"
#include "tile/block_samples.h"
#include "tracer/by_kind.h"
#include "tracer/by_threads.h"
#include "tracer/estimators/sky_estimator.h"
#include "tracer/flush_denormals.h"
#include "tracer/joint_sets.h"
#include "tracer/photon_loop.h"
#include "tracer/pixel_sample.h"

namespace nocturne {
namespace {

using Xyz = std::array<double, TileSums::kXyzValues>;
constexpr std::size_t kY = 1;

/// Of one pixel at a time: its sums come in the order of its samples, whatever the threads.
template <int N, bool Media>
class DaylightPixel {
 public:
  DaylightPixel(const Scene& scene, Film film, float sun_radius, const std::stop_token& stop = {})
      : scene_(scene),
        film_(film),
        sun_radius_(sun_radius),
        size_(samples_in_batch(scene.options, kBatchGroups)),
        of_sky_(scene, false),
        of_suns_(scene, true),
        sky_batch_(scene, of_sky_, stop),
        sun_batch_(scene, of_suns_, stop) {}

  PixelSequence numbers_of(std::uint32_t pixel) const {
    return PixelSequence(scene_.options.sequence, scene_.options.seed, pixel,
                         joint_sets_of_pixel(sets_of_pixel(scene_), scene_.sensor.aims()));
  }

  /// f(sample, direction, whether it came straight, X, Y, Z) for all that some samples meet.
  template <class F>
  void trace_sky(PixelSequence& numbers, std::uint32_t pixel, std::uint32_t first,
                 std::uint32_t end, TileSums& counts, const F& f) {
    for (; first < end; first += size_) {
      trace_batch_of_sky(numbers, pixel, first, std::min(first + size_, end), counts, f);
    }
  }

  /// One photon to each sun, from the same place and with the same wavelengths: f(number of the
  /// sun, X, Y, Z). Returns the illuminance across the beam of a sun of 1, for these wavelengths.
  template <class F>
  double trace_suns(PixelSequence& numbers, std::uint32_t pixel, std::uint32_t index,
                    const std::vector<Vec3>& suns, TileSums& counts, const F& f) {
    PhotonSequence sequence(numbers, index);
    PixelSample<N> sample = sample_at(pixel, sequence);
    const Uniform4 u = sequence.next();
    const Vec3 normal = *sample.start.film_normal;
    sample.start.film_normal.reset();
    const Spectral<N> white = scene_.distant_radiance(suns.front(), sample.wavelengths.nm);
    const double across = seen(sample.wavelengths, white, counts)[kY];
    const float radius = sun_radius_ * std::sqrt(u[0]);
    const float x = radius * math::cos(kTwoPi * u[1]), y = radius * math::sin(kTwoPi * u[1]);
    for (std::size_t first = 0; first < suns.size(); first += size_) {
      const std::size_t end = std::min<std::size_t>(first + size_, suns.size());
      sun_batch_.clear();
      of_suns_.reset(end - first);
      of_suns_.met().clear();
      which_.clear();
      for (std::size_t i = first; i < end; ++i) {
        const Vec3 direction = normalized(Frame(suns[i]).to_world({x, y, 1.0f}));
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
        Xyz value = seen(sample.wavelengths, met.light * white, counts);
        for (double& each : value) each = sample.weight / kPi * cosine * each;
        f(sun, value);
      }
    }
    return across;
  }

 private:
  PixelSample<N> sample_at(std::uint32_t pixel, PhotonSequence& sequence) const {
    const PixelNumbers numbers = next_pixel_numbers(scene_, sequence);
    return sample_pixel<N>(scene_, film_, pixel % film_.width, pixel / film_.width, numbers);
  }

  template <class F>
  void trace_batch_of_sky(PixelSequence& numbers, std::uint32_t pixel, std::uint32_t first,
                          std::uint32_t end, TileSums& counts, const F& f) {
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
    for (const auto& met : of_sky_.met()) {
      const PixelSample<N>& sample = samples_[met.tally];
      Xyz value = seen(sample.wavelengths, met.light, counts);
      for (double& each : value) each *= sample.weight;
      f(first + met.tally, met.direction, met.straight, value);
    }
  }

  template <class Batch>
  void finish(Batch& batch, SkyEstimator<N>& estimator, std::size_t samples, TileSums& counts) {
    trace_batch(batch);
    // Of one sample in the order in which they were met, which does not depend on the others.
    std::ranges::stable_sort(estimator.met(), {}, &SkyEstimator<N>::Met::tally);
    counts.photons += samples * N;
    counts.rays += batch.rays;
    counts.truncated_paths += batch.limits.truncated();
  }

  /// The means over a group's photons of the response x light.
  Xyz seen(const WavelengthSamples<N>& wavelengths, const Spectral<N>& light,
           TileSums& counts) const {
    Xyz sums{};
    for (std::size_t k = 0; k < N; ++k) {
      if (!std::isfinite(light[k]) || light[k] < 0.0f) {
        ++counts.invalid_samples;
        continue;
      }
      for (std::size_t c = 0; c < sums.size(); ++c) {
        sums[c] += static_cast<double>(wavelengths.weight[c][k]) * light[k];
      }
    }
    for (double& each : sums) each /= N;
    return sums;
  }

  struct SunRay {
    std::size_t sun;
    float cosine;
  };

  const Scene& scene_;
  const Film film_;
  const float sun_radius_;
  const std::uint32_t size_;
  SkyEstimator<N> of_sky_, of_suns_;
  Batch<N, SkyEstimator<N>, Media> sky_batch_, sun_batch_;
  std::vector<PixelSample<N>> samples_;
  std::vector<SunRay> which_;
};

/// What samples of one pixel measure, in their order.
class PixelValues {
 public:
  void clear(std::uint32_t first, std::uint32_t end) {
    first_ = first;
    values_.assign(std::size_t{end} - first, Xyz{});
  }
  void add(std::uint32_t sample, const Xyz& value, double times = 1.0) {
    Xyz& sum = values_[sample - first_];
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += times * value[c];
  }
  const std::vector<Xyz>& values() const { return values_; }

 private:
  std::uint32_t first_ = 0;
  std::vector<Xyz> values_;
};

/// Of a tile, 256 MB.
constexpr std::size_t kMostNumbers = std::size_t{1} << 25;

template <int N, bool Media>
void trace_pixels_of_tile(const Scene& scene, const DaylightCoefficients& daylight, Film film,
                          const TileRange& range, const std::stop_token& stop, DaylightTile& tile) {
  const std::size_t count = daylight.count();
  DaylightPixel<N, Media> pixel(scene, film, kSunRadius, stop);
  PixelValues values;
  // What comes straight and all else are added up apart, as trace_daylight does.
  std::vector<double> straight(count);
  TileSums& sums_of_tile = tile.sums;
  BlockSamples blocks(sums_of_tile, range.end_sample - range.first_sample);
  for (std::uint32_t i = 0; i < range.width * range.height; ++i) {
    const std::uint32_t x = i % range.width, y = i / range.width;
    const std::uint32_t number = (range.y + y) * film.width + range.x + x;
    PixelSequence numbers = pixel.numbers_of(number);
    values.clear(range.first_sample, range.end_sample);
    double* const sums = &tile.coefficients[i * count];
    if (daylight.suns.empty()) {
      std::ranges::fill(straight, 0.0);
      pixel.trace_sky(
          numbers, number, range.first_sample, range.end_sample, sums_of_tile,
          [&](std::uint32_t sample, Vec3 direction, bool is_straight, const Xyz& value) {
            values.add(sample, value);
            const std::uint32_t at = daylight.places[daylight.patches.number(direction)];
            if (at == DaylightCoefficients::kNotCounted) return;
            if (!is_straight) sums[at] += value[kY];
            if (is_straight && !daylight.reflected_alone) straight[at] += value[kY];
          });
      for (std::size_t c = 0; c < count; ++c) sums[c] = straight[c] + sums[c];
    } else {
      const double part = 1.0 / static_cast<double>(daylight.suns.size());
      for (std::uint32_t j = range.first_sample; j < range.end_sample; ++j) {
        const auto found = [&](std::size_t sun, const Xyz& value) {
          values.add(j, value, part);
          sums[sun] += value[kY];
        };
        sums[count - 1] += pixel.trace_suns(numbers, number, j, daylight.suns, sums_of_tile, found);
      }
    }
    std::uint32_t sample = 0;
    for (const Xyz& value : values.values()) {
      add_sample(value.data(), 0, &sums_of_tile.sums[i * sums_of_tile.channels]);
      blocks.add(x, y, sample++, value.data());
    }
  }
  blocks.add_to(sums_of_tile);
  // By samples: each may have been sent to all suns.
  sums_of_tile.photons = std::uint64_t{range.width} * range.height *
                         (range.end_sample - range.first_sample) * scene.options.group;
}

/// Pixels of a piece of work.
constexpr std::uint32_t kPiece = 16;

template <int N, bool Media>
void trace_pixel(DaylightPixel<N, Media>& pixel, const DaylightRequest& request, std::uint32_t i,
                 TileSums& counts, DaylightSums& sums) {
  PixelSequence numbers = pixel.numbers_of(i);
  const std::size_t count = request.patches.count(), suns = request.suns.size();
  pixel.trace_sky(numbers, i, request.first_sample, request.end_sample, counts,
                  [&](std::uint32_t, Vec3 direction, bool straight, const Xyz& value) {
                    const std::size_t part = std::size_t{i} * 2 + (straight ? 0 : 1);
                    sums.patches[part * count + request.patches.number(direction)] += value[kY];
                  });
  if (request.suns.empty()) return;
  for (std::uint32_t j = request.first_sample; j < request.end_sample; ++j) {
    sums.across[i] += pixel.trace_suns(
        numbers, i, j, request.suns, counts,
        [&](std::size_t sun, const Xyz& value) { sums.suns[i * suns + sun] += value[kY]; });
  }
}

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
    TileSums counts(1, 1, 0);
    by_kind_of(scene, [&]<int N, bool Media>() {
      DaylightPixel<N, Media> pixel(scene, request.film, request.sun_radius);
      for (std::uint32_t i = first; i < end; ++i) trace_pixel(pixel, request, i, counts, sums);
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

DaylightTile trace_daylight_tile(const Scene& scene, const DaylightCoefficients& daylight,
                                 Film film, const TileRange& range, const std::stop_token& stop) {
  const std::size_t pixels = std::size_t{range.width} * range.height;
  if (daylight.count() > kMostNumbers / pixels) {
    throw std::invalid_argument("a tile with too many daylight coefficients");
  }
  const FlushDenormals flush;
  DaylightTile tile{TileSums(range.width, range.height, 0),
                    std::vector<double>(pixels * daylight.count())};
  by_kind_of(scene, [&]<int N, bool Media>() {
    trace_pixels_of_tile<N, Media>(scene, daylight, film, range, stop, tile);
  });
  return tile;
}

}  // namespace nocturne

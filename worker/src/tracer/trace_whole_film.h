// Films by forward photons, or by photons from both ends. Forward photons fall anywhere on the
// film. As many as it has pixels, and with both directions one adjoint photon from each pixel, make
// one sample of the whole film, so that means and errors are those of any other image.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "tile/block_samples.h"
#include "tracer/estimators/camera_estimator.h"
#include "tracer/estimators/sensor_estimator.h"
#include "tracer/photon_batches.h"
#include "tracer/pixel_batches.h"
#include "tracer/response.h"

namespace nocturne {

/// What some samples of the film measure, pixel by pixel, before it is added to the film's sums.
class FilmSamples {
 public:
  FilmSamples(std::uint32_t samples, std::uint32_t pixels, std::size_t values)
      : pixels_(pixels),
        per_pixel_(values),
        values_(static_cast<std::size_t>(samples) * pixels * values, 0.0),
        touched_(static_cast<std::size_t>(samples) * pixels, 0) {}

  /// The values of a pixel in one of the samples, to be added to.
  double* touch(std::uint32_t sample, std::uint32_t pixel) {
    const std::size_t cell = static_cast<std::size_t>(sample) * pixels_ + pixel;
    if (touched_[cell] == 0) {
      touched_[cell] = 1;
      cells_.push_back(cell);
    }
    return &values_[cell * per_pixel_];
  }

  /// Adds the touched pixels to the film's sums, in the order of the samples; `first` is the number
  /// of the first of these samples in `blocks`.
  void add_to(TileSums& film, BlockSamples& blocks, std::uint32_t first) {
    std::sort(cells_.begin(), cells_.end());
    for (const std::size_t cell : cells_) {
      double* const values = &values_[cell * per_pixel_];
      const auto pixel = static_cast<std::uint32_t>(cell % pixels_);
      const auto sample = static_cast<std::uint32_t>(cell / pixels_);
      add_sample(values, film.further, &film.sums[pixel * film.channels]);
      blocks.add(pixel % film.width, pixel / film.width, first + sample, values);
      std::fill_n(values, per_pixel_, 0.0);
      touched_[cell] = 0;
    }
    cells_.clear();
  }

 private:
  const std::uint32_t pixels_;
  const std::size_t per_pixel_;
  std::vector<double> values_;
  std::vector<char> touched_;
  std::vector<std::size_t> cells_;
};

template <int N, class Estimator, bool Media>
class WholeFilm {
 public:
  /// `from_pixels`: each pixel's adjoint photons, too.
  WholeFilm(const Scene& scene, Film film, std::uint32_t groups, bool from_pixels,
            const std::stop_token& stop)
      : both_(from_pixels),
        width_(film.width),
        pixels_(film.width * film.height),
        sharing_(scene.options.sharing),
        batch_size_(samples_in_batch(scene.options, groups)),
        // Small films several samples at a time, so that batches are full.
        samples_at_once_(std::max(1u, batch_size_ / pixels_)),
        photons_(scene, film, stop),
        from_pixels_(scene, film, batch_size_, stop),
        sums_(film.width, film.height, scene.wavelengths.further_curves()),
        samples_(samples_at_once_, pixels_, sums_.values()),
        measured_(batch_size_ * sums_.values()) {}

  TileSums trace(std::uint32_t first_sample, std::uint32_t end_sample) {
    BlockSamples blocks(sums_, end_sample - first_sample);
    for (std::uint32_t first = first_sample; first < end_sample; first += samples_at_once_) {
      const std::uint32_t end = std::min(end_sample, first + samples_at_once_);
      trace_photons(first, end);
      if (both_) trace_from_pixels(first, end);
      samples_.add_to(sums_, blocks, first - first_sample);
    }
    blocks.add_to(sums_);
    return std::move(sums_);
  }

 private:
  void trace_photons(std::uint32_t first, std::uint32_t end) {
    const std::uint64_t begin = std::uint64_t{first} * pixels_,
                        end_photon = std::uint64_t{end} * pixels_;
    for (std::uint64_t photon = begin; photon < end_photon; photon += batch_size_) {
      photons_.trace(photon, std::min<std::uint64_t>(batch_size_, end_photon - photon), sums_);
      for (const Splat<N>& splat : photons_.splats()) {
        const std::uint64_t sample = (photon - begin + splat.sample) / pixels_;
        double* const values = samples_.touch(static_cast<std::uint32_t>(sample), splat.pixel);
        sums_.invalid_samples += photons_.add(splat, values);
      }
    }
  }

  void trace_from_pixels(std::uint32_t first, std::uint32_t end) {
    std::vector<PixelIndex> samples;
    const auto trace = [&] {
      std::fill(measured_.begin(), measured_.end(), 0.0);
      from_pixels_.trace(samples, sums_, measured_.data());
      const double* measured = measured_.data();
      for (const PixelIndex& at : samples) {
        double* const values = samples_.touch(at.sample - first, at.y * width_ + at.x);
        for (std::size_t c = 0; c < sums_.values(); ++c) values[c] += *measured++;
      }
      samples.clear();
    };
    for (std::uint32_t sample = first; sample < end; ++sample) {
      for_each_sample(
          {0, 0, width_, pixels_ / width_, sample, sample + 1}, sharing_,
          [&](std::size_t together) {
            if (samples.size() + together > batch_size_) trace();
          },
          [&](const PixelIndex& at) { samples.push_back(at); });
    }
    trace();
  }

  const bool both_;
  const std::uint32_t width_, pixels_, sharing_, batch_size_, samples_at_once_;
  PhotonBatches<N, Estimator, Media> photons_;
  PixelBatches<N, Media> from_pixels_;
  TileSums sums_;
  FilmSamples samples_;
  std::vector<double> measured_;
};

}  // namespace nocturne

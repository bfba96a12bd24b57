#include "tracer/trace_photon_range.h"

#include <algorithm>
#include <array>
#include <compare>
#include <stdexcept>
#include <vector>

#include "tracer/by_kind.h"
#include "tracer/estimators/camera_estimator.h"
#include "tracer/estimators/sensor_estimator.h"
#include "tracer/flush_denormals.h"
#include "tracer/photon_batches.h"
#include "tracer/response.h"

namespace nocturne {
namespace {

template <int N, class Estimator, bool Media>
class PhotonsOnFilm {
 public:
  PhotonsOnFilm(const Scene& scene, Film film, std::uint32_t tile_size, const std::stop_token& stop)
      : tile_blocks_(TileSums::blocks_in(tile_size)),
        tile_columns_((film.width + tile_size - 1) / tile_size),
        batch_size_(samples_in_batch(scene.options, kBatchGroups)),
        photons_(scene, film, stop),
        sums_(film.width, film.height, scene.wavelengths.further_curves(),
              std::size_t{tile_columns_} * ((film.height + tile_size - 1) / tile_size)),
        of_pixel_(sums_.values()),
        of_tile_(sums_.values()) {}

  TileSums trace(std::uint64_t first, std::uint64_t end) {
    for (std::uint64_t photon = first; photon < end; photon += batch_size_) {
      photons_.trace(photon, std::min<std::uint64_t>(batch_size_, end - photon), sums_);
      add_splats();
    }
    return std::move(sums_);
  }

 private:
  /// Where a splat fell, and its place among all: those of one pixel, block and tile lie together.
  struct Fallen {
    std::uint32_t tile, block, pixel, splat;

    auto operator<=>(const Fallen&) const = default;
  };

  void add_splats() {
    const std::vector<Splat<N>>& splats = photons_.splats();
    for (std::uint32_t i = 0; i < splats.size(); ++i) {
      fallen_.push_back(fallen(splats[i].pixel, i));
      if (i + 1 < splats.size() && splats[i + 1].sample == splats[i].sample) continue;
      add_photon();
      fallen_.clear();
    }
  }

  Fallen fallen(std::uint32_t pixel, std::uint32_t splat) const {
    const std::uint32_t x = pixel % sums_.width / TileSums::kBlock;
    const std::uint32_t y = pixel / sums_.width / TileSums::kBlock;
    return {y / tile_blocks_ * tile_columns_ + x / tile_blocks_, y * sums_.block_columns() + x,
            pixel, splat};
  }

  /// All light that one photon brought: its sum in a pixel, a block and a tile is squared there.
  void add_photon() {
    std::ranges::sort(fallen_);
    for (std::size_t i = 0; i < fallen_.size(); ++i) {
      const Fallen& at = fallen_[i];
      const Fallen* const next = i + 1 < fallen_.size() ? &fallen_[i + 1] : nullptr;
      sums_.invalid_samples += photons_.add(photons_.splats()[at.splat], of_pixel_.data());
      if (next != nullptr && next->pixel == at.pixel) continue;
      for (std::size_t c = 0; c < of_block_.size(); ++c) of_block_[c] += of_pixel_[c];
      for (std::size_t c = of_block_.size(); c < of_pixel_.size(); ++c) of_tile_[c] += of_pixel_[c];
      add_sample(of_pixel_.data(), sums_.further, &sums_.sums[at.pixel * sums_.channels]);
      std::ranges::fill(of_pixel_, 0.0);
      if (next != nullptr && next->block == at.block) continue;
      for (std::size_t c = 0; c < of_block_.size(); ++c) of_tile_[c] += of_block_[c];
      add_products(of_block_.data(), &sums_.block_products[at.block * TileSums::kProducts]);
      of_block_.fill(0.0);
      if (next != nullptr && next->tile == at.tile) continue;
      double* const of_tile = &sums_.tile_products[at.tile * sums_.products_of_tile()];
      add_products(of_tile_.data(), of_tile);
      add_further_products(of_tile_.data(), sums_.further, of_tile + TileSums::kProducts);
      std::ranges::fill(of_tile_, 0.0);
    }
  }

  using Xyz = std::array<double, TileSums::kXyzValues>;

  static void add_products(const double* xyz, double* sums) {
    const auto products = products_of(xyz);
    for (std::size_t i = 0; i < products.size(); ++i) sums[i] += products[i];
  }

  const std::uint32_t tile_blocks_, tile_columns_, batch_size_;
  PhotonBatches<N, Estimator, Media> photons_;
  TileSums sums_;
  std::vector<Fallen> fallen_;
  std::vector<double> of_pixel_, of_tile_;
  Xyz of_block_{};
};

}  // namespace

TileSums trace_photons(const Scene& scene, Film film, std::uint32_t tile_size, std::uint64_t first,
                       std::uint64_t end, const std::stop_token& stop) {
  if (scene.options.direction == Direction::kAdjoint) {
    throw std::invalid_argument("forward photons of a scene that has none");
  }
  const FlushDenormals flush;
  TileSums sums = by_kind_of(scene, [&]<int N, bool Media>() {
    const auto trace = [&](auto photons) { return photons.trace(first, end); };
    return scene.options.direction == Direction::kForward
               ? trace(PhotonsOnFilm<N, SensorEstimator<N>, Media>(scene, film, tile_size, stop))
               : trace(PhotonsOnFilm<N, CameraEstimator<N>, Media>(scene, film, tile_size, stop));
  });
  sums.photons = (end - first) * scene.options.group;
  return sums;
}

TileSums trace_photon_range(const Scene& scene, Film film, std::uint32_t tile_size,
                            const PhotonRange& range, const std::stop_token& stop) {
  TileSums sums = trace_photons(scene, film, tile_size, range.first * kPhotonBundle,
                                range.end * kPhotonBundle, stop);
  round_photon_sums(sums);
  return sums;
}

}  // namespace nocturne

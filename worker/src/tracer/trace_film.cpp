#include "tracer/trace_film.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <vector>

#include "tracer/by_threads.h"
#include "tracer/trace_photon_range.h"

namespace nocturne {
namespace {

// Adds rows of `row` values to rows of `to_row` values, from value `first` on.
void add_rows(const std::vector<double>& from, std::size_t row, std::vector<double>& to,
              std::size_t to_row, std::size_t first) {
  for (std::size_t at = 0; at < from.size(); at += row, first += to_row) {
    for (std::size_t i = 0; i < row; ++i) to[first + i] += from[at + i];
  }
}

/// Some ranges one after the other, and where the first of them begins.
struct Ranges {
  std::uint32_t first;
  std::span<const std::uint32_t> ends;

  std::uint32_t end() const { return ends.empty() ? first : ends.back(); }
};

/// A film's sums, to which ranges are added: of its tiles, and of forward photons.
class GrowingFilm {
 public:
  GrowingFilm(const Scene& scene, const FilmPlan& plan, unsigned threads,
              const std::function<void(double)>& progress)
      : scene_(scene),
        plan_(plan),
        threads_(threads),
        progress_(progress),
        columns_(tiles_in(plan.film.width)),
        rows_(tiles_in(plan.film.height)),
        tiles_(no_sums()) {
    if (!plan.photon_ends.empty()) photons_.push_back(no_sums());
    const auto last = [](std::span<const std::uint32_t> ends) {
      return ends.empty() ? 0.0 : static_cast<double>(ends.back());
    };
    all_ = static_cast<double>(plan.film.width) * plan.film.height * last(plan.range_ends) +
           static_cast<double>(kPhotonBundle) * last(plan.photon_ends);
  }

  /// Traces ranges of all tiles, and of forward photons.
  void add(const Ranges& samples, const Ranges& photons) {
    const std::size_t photon_ranges = photons.ends.size();
    // Ranges of photons take longest, and are begun first.
    by_threads(photon_ranges + std::size_t{columns_} * rows_, threads_, [&](std::size_t i) {
      if (i < photon_ranges) {
        add_photons_in_order(i == 0 ? photons.first : photons.ends[i - 1], photons.ends[i]);
      } else {
        trace_tile_ranges(i - photon_ranges, samples);
      }
    });
    samples_ = samples.end();
  }

  /// What all ranges so far measure together, and of how many samples of each pixel that is.
  std::pair<TileSums, std::uint32_t> image() const& { return with_photons(tiles_); }
  std::pair<TileSums, std::uint32_t> image() && { return with_photons(std::move(tiles_)); }

 private:
  std::uint32_t tiles_in(std::uint32_t pixels) const {
    return (pixels + plan_.tile_size - 1) / plan_.tile_size;
  }

  std::pair<TileSums, std::uint32_t> with_photons(TileSums film) const {
    const std::uint32_t samples =
        plan_.range_ends.empty() ? plan_.samples_of(added_bundles_) : samples_;
    if (!photons_.empty()) {
      add_photons(photons_.front(), added_bundles_, samples, plan_.tile_size, film);
    }
    return {std::move(film), samples};
  }

  TileSums no_sums() const {
    return {plan_.film.width, plan_.film.height, scene_.wavelengths.further_curves(),
            std::size_t{columns_} * rows_};
  }

  void trace_tile_ranges(std::size_t index, const Ranges& samples) {
    const auto column = static_cast<std::uint32_t>(index % columns_);
    const auto row = static_cast<std::uint32_t>(index / columns_);
    TileRange tile{column * plan_.tile_size, row * plan_.tile_size, 0, 0, samples.first, 0};
    tile.width = std::min(plan_.tile_size, plan_.film.width - tile.x);
    tile.height = std::min(plan_.tile_size, plan_.film.height - tile.y);
    TileSums total(tile.width, tile.height, scene_.wavelengths.further_curves());
    for (const std::uint32_t end : samples.ends) {
      tile.end_sample = end;
      total += trace_tile(scene_, plan_.film, tile);
      report(std::uint64_t{tile.width} * tile.height * (end - tile.first_sample));
      tile.first_sample = end;
    }
    const std::lock_guard lock(mutex_);
    add_tile(total, tile, index, tiles_);
  }

  /// Waits for the ranges before it, of which other threads are at work: so there are never more
  /// sums of whole films than threads.
  void add_photons_in_order(std::uint32_t first, std::uint32_t end) {
    try {
      const TileSums found = trace_photon_range(scene_, plan_.film, plan_.tile_size, {first, end});
      std::unique_lock lock(mutex_);
      turn_.wait(lock, [&] { return added_bundles_ == first || failed_; });
      if (failed_) return;
      photons_.front() += found;
      added_bundles_ = end;
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failed_ = true;
      turn_.notify_all();
      throw;
    }
    turn_.notify_all();
    report((end - first) * kPhotonBundle);
  }

  void report(std::uint64_t photons) {
    const std::lock_guard lock(mutex_);
    done_ += static_cast<double>(photons);
    progress_(done_ / all_);
  }

  const Scene& scene_;
  const FilmPlan& plan_;
  const unsigned threads_;
  const std::function<void(double)>& progress_;
  const std::uint32_t columns_, rows_;
  TileSums tiles_;
  /// None or one.
  std::vector<TileSums> photons_;
  std::uint32_t added_bundles_ = 0, samples_ = 0;
  bool failed_ = false;
  std::condition_variable turn_;
  std::mutex mutex_;
  double all_ = 0.0, done_ = 0.0;
};

/// Of the photon ranges from `first` on, those that begin below this part of all bundles; at least
/// one at the start.
Ranges photon_ranges_for(std::span<const std::uint32_t> ends, std::size_t first_range,
                         double part) {
  const std::uint32_t first = first_range == 0 ? 0 : ends[first_range - 1];
  std::size_t last = first_range;
  while (last < ends.size() && (last == 0 ? 0 : ends[last - 1]) < part * ends.back()) ++last;
  return {first, ends.subspan(first_range, last - first_range)};
}

}  // namespace

void add_tile(const TileSums& tile, const TileRange& where, std::size_t index, TileSums& film) {
  add_rows(tile.sums, tile.channels * tile.width, film.sums, film.channels * film.width,
           film.channels * (std::size_t{where.y} * film.width + where.x));
  constexpr std::size_t kProducts = TileSums::kProducts;
  const std::size_t columns = film.block_columns();
  add_rows(tile.block_products, kProducts * tile.block_columns(), film.block_products,
           kProducts * columns,
           kProducts * (where.y / TileSums::kBlock * columns + where.x / TileSums::kBlock));
  const std::size_t of_tile = film.products_of_tile();
  for (std::size_t i = 0; i < of_tile; ++i) {
    film.tile_products[of_tile * index + i] += tile.tile_products[i];
  }
  film.add_counts(tile);
}

std::uint32_t FilmPlan::samples_of(std::uint32_t bundles) const {
  const std::uint64_t pixels = std::uint64_t{film.width} * film.height;
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, bundles * kPhotonBundle / pixels));
}

std::pair<TileSums, std::uint32_t> trace_film(const Scene& scene, const FilmPlan& plan,
                                              unsigned threads,
                                              const std::function<void(double)>& progress) {
  GrowingFilm film(scene, plan, threads, progress);
  film.add({0, plan.range_ends}, {0, plan.photon_ends});
  return std::move(film).image();
}

std::pair<TileSums, std::uint32_t> trace_film_by_ranges(
    const Scene& scene, const FilmPlan& plan, unsigned threads,
    const std::function<void(double)>& progress,
    const std::function<bool(std::uint32_t, const TileSums&)>& go_on) {
  GrowingFilm film(scene, plan, threads, progress);
  std::uint32_t first = 0;
  std::size_t photon_ranges = 0;
  const bool has_tiles = !plan.range_ends.empty();
  const auto& steps = has_tiles ? plan.range_ends : plan.photon_ends;
  for (const std::uint32_t& end : steps) {
    const Ranges photons =
        photon_ranges_for(plan.photon_ends, photon_ranges, static_cast<double>(end) / steps.back());
    film.add(has_tiles ? Ranges{first, {&end, 1}} : Ranges{0, {}}, photons);
    photon_ranges += photons.ends.size();
    first = end;
    if (end == steps.back()) break;
    const auto [sums, samples] = film.image();
    if (!go_on(samples, sums)) break;
  }
  return std::move(film).image();
}

}  // namespace nocturne

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

std::uint64_t pixels_of(const Film& film) { return std::uint64_t{film.width} * film.height; }

double last_of(std::span<const std::uint32_t> ends) {
  return ends.empty() ? 0.0 : static_cast<double>(ends.back());
}

double photons_of(const FilmPlan& plan) {
  return static_cast<double>(pixels_of(plan.film)) * last_of(plan.range_ends) +
         static_cast<double>(kPhotonBundle) * last_of(plan.photon_ends);
}

/// A film's sums: of its tiles, and of forward photons.
class FilmSums {
 public:
  FilmSums(const FilmPlan& plan, std::size_t further)
      : plan_(plan), tiles_(no_sums(plan, further)) {
    if (!plan.photon_ends.empty()) photons_.push_back(no_sums(plan, further));
  }

  void add(const TileSums& tile, std::size_t index) {
    add_tile(tile, plan_.tile(index), index, tiles_);
  }
  /// A range of forward photons, after those before it.
  void add_photon_range(const TileSums& found, std::uint32_t end) {
    photons_.front() += found;
    added_bundles_ = end;
  }
  std::uint32_t added_bundles() const { return added_bundles_; }

  /// What all so far measures together, and of how many samples of each pixel that is; `samples`:
  /// of the tiles.
  std::pair<TileSums, std::uint32_t> image(std::uint32_t samples) const& {
    return with_photons(tiles_, samples);
  }
  std::pair<TileSums, std::uint32_t> image(std::uint32_t samples) && {
    return with_photons(std::move(tiles_), samples);
  }

 private:
  static TileSums no_sums(const FilmPlan& plan, std::size_t further) {
    return {plan.film.width, plan.film.height, further, plan.tiles()};
  }

  std::pair<TileSums, std::uint32_t> with_photons(TileSums film, std::uint32_t samples) const {
    if (plan_.range_ends.empty()) samples = plan_.samples_of(added_bundles_);
    if (!photons_.empty()) {
      add_photons(photons_.front(), added_bundles_, samples, plan_.tile_size, film);
    }
    return {std::move(film), samples};
  }

  const FilmPlan& plan_;
  TileSums tiles_;
  /// None or one.
  std::vector<TileSums> photons_;
  std::uint32_t added_bundles_ = 0;
};

/// A tile's ranges, added up in sample order. `done` gets the photons of each.
template <class Done>
TileSums trace_ranges(const Scene& scene, const FilmPlan& plan, std::size_t index,
                      const Ranges& samples, const Done& done) {
  TileRange tile = plan.tile(index);
  tile.first_sample = samples.first;
  TileSums total(tile.width, tile.height, scene.wavelengths.further_curves());
  for (const std::uint32_t end : samples.ends) {
    tile.end_sample = end;
    total += trace_tile(scene, plan.film, tile);
    done(std::uint64_t{tile.width} * tile.height * (end - tile.first_sample));
    tile.first_sample = end;
  }
  return total;
}

/// A film to which ranges are added by several threads.
class GrowingFilm {
 public:
  GrowingFilm(const Scene& scene, const FilmPlan& plan, unsigned threads,
              const std::function<void(double)>& progress)
      : scene_(scene),
        plan_(plan),
        threads_(threads),
        progress_(progress),
        sums_(plan, scene.wavelengths.further_curves()),
        all_(photons_of(plan)) {}

  /// Traces ranges of all tiles, and of forward photons.
  void add(const Ranges& samples, const Ranges& photons) {
    const std::size_t photon_ranges = photons.ends.size();
    // Ranges of photons take longest, and are begun first.
    by_threads(photon_ranges + plan_.tiles(), threads_, [&](std::size_t i) {
      if (i < photon_ranges) {
        add_photons_in_order(i == 0 ? photons.first : photons.ends[i - 1], photons.ends[i]);
      } else {
        const auto done = [&](std::uint64_t traced) { report(traced); };
        const TileSums tile = trace_ranges(scene_, plan_, i - photon_ranges, samples, done);
        const std::lock_guard lock(mutex_);
        sums_.add(tile, i - photon_ranges);
      }
    });
    samples_ = samples.end();
  }

  std::pair<TileSums, std::uint32_t> image() const& { return sums_.image(samples_); }
  std::pair<TileSums, std::uint32_t> image() && { return std::move(sums_).image(samples_); }

 private:
  /// Waits for the ranges before it, of which other threads are at work: so there are never more
  /// sums of whole films than threads.
  void add_photons_in_order(std::uint32_t first, std::uint32_t end) {
    try {
      const TileSums found = trace_photon_range(scene_, plan_.film, plan_.tile_size, {first, end});
      std::unique_lock lock(mutex_);
      turn_.wait(lock, [&] { return sums_.added_bundles() == first || failed_; });
      if (failed_) return;
      sums_.add_photon_range(found, end);
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
  FilmSums sums_;
  std::uint32_t samples_ = 0;
  bool failed_ = false;
  std::condition_variable turn_;
  std::mutex mutex_;
  double all_, done_ = 0.0;
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
  const std::uint64_t samples = bundles * kPhotonBundle / pixels_of(film);
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, samples));
}

TileRange FilmPlan::tile(std::size_t index) const {
  const auto x = static_cast<std::uint32_t>(index % columns()) * tile_size,
             y = static_cast<std::uint32_t>(index / columns()) * tile_size;
  return {x, y, std::min(tile_size, film.width - x), std::min(tile_size, film.height - y), 0, 0};
}

double FilmPlan::share(std::size_t piece) const {
  if (piece < photon_ends.size()) {
    const std::uint32_t first = piece == 0 ? 0 : photon_ends[piece - 1];
    const std::uint64_t photons = (photon_ends[piece] - first) * kPhotonBundle;
    return static_cast<double>(photons) / photons_of(*this);
  }
  const TileRange where = tile(piece - photon_ends.size());
  return static_cast<double>(where.width) * where.height * last_of(range_ends) / photons_of(*this);
}

TileSums trace_piece(const Scene& scene, const FilmPlan& plan, std::size_t piece) {
  const std::size_t photon_ranges = plan.photon_ends.size();
  if (piece >= photon_ranges) {
    return trace_ranges(scene, plan, piece - photon_ranges, {0, plan.range_ends},
                        [](std::uint64_t) {});
  }
  const std::uint32_t first = piece == 0 ? 0 : plan.photon_ends[piece - 1];
  return trace_photon_range(scene, plan.film, plan.tile_size, {first, plan.photon_ends[piece]});
}

std::pair<TileSums, std::uint32_t> join_pieces(
    const FilmPlan& plan, std::size_t further,
    const std::function<TileSums(std::size_t piece)>& find) {
  FilmSums sums(plan, further);
  const std::size_t photon_ranges = plan.photon_ends.size();
  for (std::size_t piece = 0; piece < plan.pieces(); ++piece) {
    if (piece < photon_ranges) {
      sums.add_photon_range(find(piece), plan.photon_ends[piece]);
    } else {
      sums.add(find(piece), piece - photon_ranges);
    }
  }
  return std::move(sums).image(plan.range_ends.empty() ? 0 : plan.range_ends.back());
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
    const std::function<bool(std::uint32_t, const TileSums&)>& wants_more) {
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
    if (!wants_more(samples, sums)) break;
  }
  return std::move(film).image();
}

}  // namespace nocturne

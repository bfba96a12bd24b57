#include "tracer/trace_film.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace nocturne {
namespace {

// All ranges of one tile, merged; `merge` says how far it is after each.
template <class Merged>
TileSums trace_ranges(const Scene& scene, const FilmPlan& plan, TileRange tile, Method method,
                      const Merged& merged) {
  TileSums total(static_cast<std::size_t>(tile.width) * tile.height,
                 scene.wavelengths.further_curves());
  for (const std::uint32_t end : plan.range_ends) {
    tile.end_sample = end;
    const TileSums range = trace_tile(scene, plan.film, tile, method);
    for (std::size_t i = 0; i < total.sums.size(); ++i) total.sums[i] += range.sums[i];
    total.photons += range.photons;
    total.rays += range.rays;
    total.invalid_samples += range.invalid_samples;
    total.truncated_paths += range.truncated_paths;
    tile.first_sample = end;
    merged(range.photons);
  }
  return total;
}

void place(const TileSums& tile, const TileRange& where, Film film, TileSums& image) {
  const std::size_t row = image.channels * where.width;
  for (std::uint32_t y = 0; y < where.height; ++y) {
    const std::size_t to =
        image.channels * ((static_cast<std::size_t>(where.y) + y) * film.width + where.x);
    std::copy_n(tile.sums.begin() + static_cast<std::ptrdiff_t>(y * row), row,
                image.sums.begin() + static_cast<std::ptrdiff_t>(to));
  }
  image.photons += tile.photons;
  image.rays += tile.rays;
  image.invalid_samples += tile.invalid_samples;
  image.truncated_paths += tile.truncated_paths;
}

}  // namespace

TileSums trace_film(const Scene& scene, const FilmPlan& plan, Method method, unsigned threads,
                    const std::function<void(double)>& progress) {
  const std::uint32_t columns = (plan.film.width + plan.tile_size - 1) / plan.tile_size;
  const std::uint32_t rows = (plan.film.height + plan.tile_size - 1) / plan.tile_size;
  const double all = static_cast<double>(plan.film.width) * plan.film.height *
                     (plan.range_ends.back() - plan.first_sample);
  TileSums image(static_cast<std::size_t>(plan.film.width) * plan.film.height,
                 scene.wavelengths.further_curves());
  std::atomic<std::uint32_t> next = 0;
  std::mutex mutex;
  double done = 0.0;
  std::exception_ptr failure;

  const auto trace_tiles = [&] {
    for (std::uint32_t index = next++; index < columns * rows; index = next++) {
      TileRange tile{(index % columns) * plan.tile_size,
                     (index / columns) * plan.tile_size,
                     0,
                     0,
                     plan.first_sample,
                     0};
      tile.width = std::min(plan.tile_size, plan.film.width - tile.x);
      tile.height = std::min(plan.tile_size, plan.film.height - tile.y);
      const TileSums sums = trace_ranges(scene, plan, tile, method, [&](std::uint64_t photons) {
        const std::lock_guard lock(mutex);
        done += static_cast<double>(photons);
        progress(done / all);
      });
      const std::lock_guard lock(mutex);
      place(sums, tile, plan.film, image);
    }
  };
  // A thread that throws stops the others; what it threw is thrown again from here.
  const auto work = [&] {
    try {
      trace_tiles();
    } catch (...) {
      next = columns * rows;
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::jthread> pool;
  for (unsigned i = 0; i < std::max(1u, threads); ++i) pool.emplace_back(work);
  pool.clear();  // joins
  if (failure) std::rethrow_exception(failure);
  return image;
}

std::pair<TileSums, std::uint32_t> trace_film_by_ranges(
    const Scene& scene, const FilmPlan& plan, Method method, unsigned threads,
    const std::function<void(double)>& progress,
    const std::function<bool(std::uint32_t, const TileSums&)>& go_on) {
  TileSums image(static_cast<std::size_t>(plan.film.width) * plan.film.height,
                 scene.wavelengths.further_curves());
  const double all = plan.range_ends.back();
  std::uint32_t first = 0;
  for (const std::uint32_t& end : plan.range_ends) {
    const FilmPlan one{plan.film, plan.tile_size, {&end, 1}, first};
    const TileSums range = trace_film(scene, one, method, threads, [&](double share) {
      progress((first + share * (end - first)) / all);
    });
    for (std::size_t i = 0; i < image.sums.size(); ++i) image.sums[i] += range.sums[i];
    image.photons += range.photons;
    image.rays += range.rays;
    image.invalid_samples += range.invalid_samples;
    image.truncated_paths += range.truncated_paths;
    first = end;
    if (end != plan.range_ends.back() && !go_on(end, image)) break;
  }
  return {std::move(image), first};
}

}  // namespace nocturne

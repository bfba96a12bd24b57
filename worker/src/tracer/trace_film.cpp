#include "tracer/trace_film.h"

#include <algorithm>
#include <mutex>
#include <vector>

#include "tracer/by_threads.h"

namespace nocturne {
namespace {

// All ranges of one tile, merged; `merge` says how far it is after each.
template <class Merged>
TileSums trace_ranges(const Scene& scene, const FilmPlan& plan, TileRange tile, Method method,
                      const Merged& merged) {
  TileSums total(tile.width, tile.height, scene.wavelengths.further_curves());
  for (const std::uint32_t end : plan.range_ends) {
    tile.end_sample = end;
    const TileSums range = trace_tile(scene, plan.film, tile, method);
    total += range;
    tile.first_sample = end;
    merged(range.photons);
  }
  return total;
}

// Copies rows of `row` values into rows of `to_row` values, from value `first` on.
void place_rows(const std::vector<double>& from, std::size_t row, std::vector<double>& to,
                std::size_t to_row, std::size_t first) {
  for (std::size_t at = 0; at < from.size(); at += row, first += to_row) {
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(at), row,
                to.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

void place(const TileSums& tile, const TileRange& where, std::size_t index, TileSums& image) {
  place_rows(tile.sums, tile.channels * tile.width, image.sums, image.channels * image.width,
             image.channels * (std::size_t{where.y} * image.width + where.x));
  constexpr std::size_t kProducts = TileSums::kProducts;
  const std::size_t columns = image.block_columns();
  place_rows(tile.block_products, kProducts * tile.block_columns(), image.block_products,
             kProducts * columns,
             kProducts * (where.y / TileSums::kBlock * columns + where.x / TileSums::kBlock));
  std::ranges::copy(tile.tile_products,
                    image.tile_products.begin() + static_cast<std::ptrdiff_t>(kProducts * index));
  image.add_counts(tile);
}

std::uint32_t tiles_in(std::uint32_t pixels, const FilmPlan& plan) {
  return (pixels + plan.tile_size - 1) / plan.tile_size;
}

TileSums no_sums(const Scene& scene, const FilmPlan& plan) {
  return {plan.film.width, plan.film.height, scene.wavelengths.further_curves(),
          std::size_t{tiles_in(plan.film.width, plan)} * tiles_in(plan.film.height, plan)};
}

}  // namespace

TileSums trace_film(const Scene& scene, const FilmPlan& plan, Method method, unsigned threads,
                    const std::function<void(double)>& progress) {
  const std::uint32_t columns = tiles_in(plan.film.width, plan);
  const std::uint32_t rows = tiles_in(plan.film.height, plan);
  const double all = static_cast<double>(plan.film.width) * plan.film.height *
                     (plan.range_ends.back() - plan.first_sample);
  TileSums image = no_sums(scene, plan);
  std::mutex mutex;
  double done = 0.0;
  by_threads(std::size_t{columns} * rows, threads, [&](std::size_t number) {
    const auto index = static_cast<std::uint32_t>(number);
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
    place(sums, tile, number, image);
  });
  return image;
}

std::pair<TileSums, std::uint32_t> trace_film_by_ranges(
    const Scene& scene, const FilmPlan& plan, Method method, unsigned threads,
    const std::function<void(double)>& progress,
    const std::function<bool(std::uint32_t, const TileSums&)>& go_on) {
  TileSums image = no_sums(scene, plan);
  const double all = plan.range_ends.back();
  std::uint32_t first = 0;
  for (const std::uint32_t& end : plan.range_ends) {
    const FilmPlan one{plan.film, plan.tile_size, {&end, 1}, first};
    const TileSums range = trace_film(scene, one, method, threads, [&](double share) {
      progress((first + share * (end - first)) / all);
    });
    image += range;
    first = end;
    if (end != plan.range_ends.back() && !go_on(end, image)) break;
  }
  return {std::move(image), first};
}

}  // namespace nocturne

#include "film_parts.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <vector>

#include "trace_files.h"
#include "tracer/by_threads.h"

namespace nocturne {
namespace {

using Counts = std::array<std::uint64_t, 4>;

std::string path_of(const PieceFiles& files, std::size_t piece) {
  return (std::filesystem::path(files.folder) / (std::to_string(piece) + ".sums")).string();
}

TileSums no_sums(const FilmPlan& plan, std::size_t further, std::size_t piece) {
  const std::size_t photon_ranges = plan.photon_ends.size();
  if (piece < photon_ranges) return {plan.film.width, plan.film.height, further, plan.tiles()};
  const TileRange tile = plan.tile(piece - photon_ranges);
  return {tile.width, tile.height, further};
}

/// Through a file of another name: one that has its name is whole.
void write_piece(const PieceFiles& files, std::size_t piece, const TileSums& sums) {
  const std::string path = path_of(files, piece), unfinished = path + ".part";
  std::ofstream file(unfinished, std::ios::binary);
  const auto write = [&](const void* from, std::size_t bytes) {
    file.write(static_cast<const char*>(from), static_cast<std::streamsize>(bytes));
  };
  write(files.key.data(), files.key.size());
  const Counts counts{sums.photons, sums.rays, sums.invalid_samples, sums.truncated_paths};
  write(counts.data(), sizeof counts);
  for (const auto* numbers : sums.numbers()) write(numbers->data(), 8 * numbers->size());
  finish(file, unfinished);
  file.close();
  std::filesystem::rename(unfinished, path);
}

/// Empty where there is no file. Throws where it is not this film's.
std::optional<TileSums> read_piece(const PieceFiles& files, std::size_t piece, TileSums sums) {
  const std::string path = path_of(files, piece);
  if (!std::filesystem::exists(path)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  std::string key(files.key.size(), '\0');
  const auto read = [&](void* into, std::size_t bytes) {
    file.read(static_cast<char*>(into), static_cast<std::streamsize>(bytes));
  };
  read(key.data(), key.size());
  if (!file || key != files.key) {
    throw std::runtime_error(path +
                             ": is of another scene or schedule, of another engine, or of a " +
                             "machine that rounds otherwise; remove it");
  }
  Counts counts{};
  read(counts.data(), sizeof counts);
  const std::array all{&sums.sums, &sums.block_products, &sums.tile_products};
  for (auto* numbers : all) read(numbers->data(), 8 * numbers->size());
  if (!file || file.peek() != std::ifstream::traits_type::eof()) {
    throw std::runtime_error(path + ": has not the size of this film's sums; remove it");
  }
  sums.photons = counts[0];
  sums.rays = counts[1];
  sums.invalid_samples = counts[2];
  sums.truncated_paths = counts[3];
  return sums;
}

}  // namespace

void trace_part(const Scene& scene, const FilmPlan& plan, const FilmPart& part,
                const PieceFiles& files, unsigned threads,
                const std::function<void(double)>& progress) {
  std::filesystem::create_directories(files.folder);
  const std::size_t further = scene.wavelengths.further_curves();
  std::vector<std::size_t> pieces;
  double all = 0.0, done = 0.0;
  for (std::size_t piece = part.part; piece < plan.pieces(); piece += part.parts) {
    if (read_piece(files, piece, no_sums(plan, further, piece))) continue;
    pieces.push_back(piece);
    all += plan.share(piece);
  }
  std::mutex mutex;
  by_threads(pieces.size(), threads, [&](std::size_t i) {
    write_piece(files, pieces[i], trace_piece(scene, plan, pieces[i]));
    const std::lock_guard lock(mutex);
    progress((done += plan.share(pieces[i])) / all);
  });
}

std::pair<TileSums, std::uint32_t> join_parts(const FilmPlan& plan, std::size_t further,
                                              const PieceFiles& files) {
  return join_pieces(plan, further, [&](std::size_t piece) {
    auto sums = read_piece(files, piece, no_sums(plan, further, piece));
    if (!sums) {
      throw std::runtime_error(path_of(files, piece) + " is missing: a part has not been traced");
    }
    return *std::move(sums);
  });
}

}  // namespace nocturne

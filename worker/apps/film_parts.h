// A film whose pieces are traced apart, by whatever runs programs, and joined at the end: each
// piece is a file with its sums.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "scene/scene.h"
#include "tracer/trace_film.h"

namespace nocturne {

/// Part `part` of `parts`: the pieces whose numbers leave it as remainder.
struct FilmPart {
  std::uint32_t part, parts;
};

/// Where the files are, and their subject: scene, schedule, engine and rounding, in 64 letters.
struct PieceFiles {
  std::string folder, key;
};

/// Traces a part's pieces into files. Those that are there already stay, so a task that was ended
/// goes on where it was. Throws what tracing throws, and std::runtime_error where a file can't be
/// written.
void trace_part(const Scene& scene, const FilmPlan& plan, const FilmPart& part,
                const PieceFiles& files, unsigned threads,
                const std::function<void(double)>& progress);

/// The film of all pieces. Throws std::runtime_error, in words, where one is missing or is not of
/// this film.
std::pair<TileSums, std::uint32_t> join_parts(const FilmPlan& plan, std::size_t further,
                                              const PieceFiles& files);

}  // namespace nocturne

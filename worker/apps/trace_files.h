// What nocturne-trace reads and writes, checked. All throw std::runtime_error, in words.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "nocturne/v1/job.pb.h"
#include "scene/load_scene.h"
#include "tracer/trace_film.h"

namespace nocturne {

template <class Message>
Message read_message(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Message message;
  if (!file || !message.ParseFromIstream(&file)) {
    throw std::runtime_error(path + ": can't be read as a " + message.GetTypeName());
  }
  return message;
}

FilmPlan checked_schedule(const v1::RangeSchedule& schedule);

/// Meshes, textures and tables in a folder, by the SHA-256 that names them.
FindBlob blobs_in(const std::string& folder);

/// All of it must have been written.
void finish(std::ofstream& file, const std::string& path);

/// Counts and times, as JSON.
void write_statistics(const std::string& path, const TileSums& image, double cpu_seconds,
                      double wall_seconds);

/// Of this process so far, all threads.
double process_cpu_seconds();

}  // namespace nocturne

// How much of the tracer's time is ray traversal: the tracer, and a bare Embree loop over the very
// rays that the tracer traced, in turns on one thread. Prints JSON; the Python part of the bench
// makes ratios of it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <span>
#include <string>

#include "nocturne/v1/scene.pb.h"
#include "ray_recorder.h"
#include "scene/load_scene.h"
#include "surfaces/embree_scene.h"
#include "tracer/trace_tile.h"

namespace nocturne::bench {
namespace {

struct Options {
  std::string scene, blobs;
  std::uint32_t edge = 256, samples = 16;
  unsigned rounds = 7;
};

struct Counts {
  std::uint64_t photons, rays;
};

std::shared_ptr<const Scene> load(const Options& options) {
  std::ifstream file(options.scene, std::ios::binary);
  v1::CompiledScene message;
  if (!file || !message.ParseFromIstream(&file)) {
    throw std::runtime_error(options.scene + ": can't be read as a compiled scene");
  }
  return load_scene(message, [&](const std::string& sha256) {
    return std::filesystem::path(options.blobs) / sha256.substr(0, 2) / sha256;
  });
}

Counts trace(const Scene& scene, const Options& options) {
  const TileSums sums = trace_tile(scene, {options.edge, options.edge},
                                   {0, 0, options.edge, options.edge, 0, options.samples});
  return {sums.photons, sums.rays};
}

RecordedRays record(const Scene& scene, const Options& options) {
  RecordedRays recorded;
  const RayRecorder recorder(recorded);
  const Counts counts = trace(scene, options);
  const std::size_t asked = recorded.nearest.size() + recorded.any.size();
  if (asked != counts.rays) {
    throw std::runtime_error("the tracer counts " + std::to_string(counts.rays) +
                             " rays, but searched for " + std::to_string(asked));
  }
  return recorded;
}

// What any user of Embree has to do for a packet of rays, and no more.
void fill(RTCRay8& packet, std::span<const RecordedRays::Segment> rays, std::array<int, 8>& valid) {
  for (std::size_t i = 0; i < 8; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    const auto& [ray, end] = rays[std::min(i, rays.size() - 1)];
    packet.org_x[i] = ray.origin.x;
    packet.org_y[i] = ray.origin.y;
    packet.org_z[i] = ray.origin.z;
    packet.dir_x[i] = ray.direction.x;
    packet.dir_y[i] = ray.direction.y;
    packet.dir_z[i] = ray.direction.z;
    packet.tnear[i] = 0.0f;
    packet.tfar[i] = end;
    packet.time[i] = 0.0f;
    packet.mask[i] = ~0u;
    packet.flags[i] = 0;
  }
}

// Gives the number of hits.
std::uint64_t trace_bare(const RecordedRays& recorded, RTCScene tree) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  alignas(32) std::array<int, 8> valid;
  std::uint64_t hits = 0;
  for (std::span<const RecordedRays::Segment> left = recorded.nearest; !left.empty();) {
    const auto some = left.first(std::min<std::size_t>(8, left.size()));
    RTCRayHit8 query;
    fill(query.ray, some, valid);
    std::fill_n(query.hit.geomID, 8, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(query.hit.instID[0], 8, RTC_INVALID_GEOMETRY_ID);
    rtcIntersect8(valid.data(), tree, &context, &query);
    for (std::size_t i = 0; i < some.size(); ++i) {
      hits += query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    }
    left = left.subspan(some.size());
  }
  for (std::span<const RecordedRays::Segment> left = recorded.any; !left.empty();) {
    const auto some = left.first(std::min<std::size_t>(8, left.size()));
    RTCRay8 query;
    fill(query, some, valid);
    rtcOccluded8(valid.data(), tree, &context, &query);
    for (std::size_t i = 0; i < some.size(); ++i) hits += query.tfar[i] < 0.0f;
    left = left.subspan(some.size());
  }
  return hits;
}

double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Work>
double cpu_seconds_of(const Work& work) {
  const double before = thread_cpu_seconds();
  work();
  return thread_cpu_seconds() - before;
}

void print_list(const char* name, const std::vector<double>& values) {
  std::printf(", \"%s\": [", name);
  for (std::size_t i = 0; i < values.size(); ++i)
    std::printf("%s%.6f", i > 0 ? ", " : "", values[i]);
  std::printf("]");
}

void run(const Options& options) {
  const auto scene = load(options);
  const RecordedRays recorded = record(*scene, options);
  Counts counts{};
  std::uint64_t hits = 0;
  std::vector<double> bare_s, tracer_s;
  const auto shapes = scene->geometry.shapes();
  const EmbreeScene tree({shapes.begin(), shapes.end()},
                         std::vector<std::uint32_t>(shapes.size(), 0), {}, {});
  const auto bare = [&] { hits = trace_bare(recorded, tree.scene); };
  const auto tracer = [&] { counts = trace(*scene, options); };
  bare();  // As memory that is new costs time; recording was the tracer's turn.
  for (unsigned round = 0; round < options.rounds; ++round) {
    // Neighbours in time share the machine's mood; alternating order cancels a drift.
    if (round % 2 == 0) bare_s.push_back(cpu_seconds_of(bare));
    tracer_s.push_back(cpu_seconds_of(tracer));
    if (round % 2 == 1) bare_s.push_back(cpu_seconds_of(bare));
  }
  std::printf("{\"photons\": %llu, \"rays\": %llu, \"hits\": %llu",
              static_cast<unsigned long long>(counts.photons),
              static_cast<unsigned long long>(counts.rays), static_cast<unsigned long long>(hits));
  print_list("tracer_cpu_seconds", tracer_s);
  print_list("bare_cpu_seconds", bare_s);
  std::printf("}\n");
}

}  // namespace
}  // namespace nocturne::bench

int main(int argc, char** argv) {
  nocturne::bench::Options options;
  CLI::App app{"Times the tracer and a bare Embree loop over the tracer's own rays.",
               "nocturne-bench-traversal"};
  app.add_option("scene", options.scene, "Compiled scene (scene.pb)")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--blobs", options.blobs, "Folder of packed meshes")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--edge", options.edge, "Width and height of the film in pixels")
      ->check(CLI::Range(1, 4096));
  app.add_option("--samples", options.samples, "Photons per pixel")->check(CLI::Range(1, 65536));
  app.add_option("--rounds", options.rounds, "Times that both are timed")
      ->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  try {
    nocturne::bench::run(options);
  } catch (const std::exception& error) {
    std::cerr << "nocturne-bench-traversal: " << error.what() << '\n';
    return 1;
  }
  return 0;
}

// The tracer alone: a compiled scene and a range schedule in, an EXR out, no service. Gives the
// bits that the service gives. One file, though long: options, their actions, and the files
// written, with nothing that anyone else would use.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "daylight_command.h"
#include "digest/sha256.h"
#include "film_parts.h"
#include "image/write_exr.h"
#include "luminaires/sky_patches.h"
#include "math/constants.h"
#include "nocturne/v1/job.pb.h"
#include "pilot_command.h"
#include "rounding/floating_point_profile.h"
#include "scene/load_daylight.h"
#include "scene/load_scene.h"
#include "trace_files.h"
#include "trace_job.h"
#include "tracer/layers.h"
#include "tracer/learning/learned_at.h"
#include "tracer/path_limits.h"
#include "tracer/trace_film.h"
#include "tracer/trace_rays.h"
#include "worker_loop/check_job.h"

namespace nocturne {
namespace {

struct Options {
  std::string scene, schedule, job, blobs, output, statistics, sums, join;
  unsigned threads = std::thread::hardware_concurrency();
  unsigned seeds = 0;
  std::uint32_t layer_samples = 0;
  std::uint64_t rays = 0;
  std::vector<std::string> pilot;
  std::vector<std::uint32_t> learned_at, part;
  DaylightCommand daylight;
  bool quiet = false;
};

// The schedule's names, which must be those of the scene's sensor.
std::vector<std::string> checked_responses(const v1::RangeSchedule& schedule,
                                           const v1::Sensor& sensor) {
  std::vector<std::string> names(schedule.further_responses().begin(),
                                 schedule.further_responses().end());
  const bool same = std::ranges::equal(
      names, sensor.further_responses(), {}, {},
      [](const v1::Response& response) -> const std::string& { return response.name(); });
  if (!same)
    throw std::runtime_error("the schedule's further responses are not those of the scene");
  return names;
}

// Names need no escapes: they are letters, digits, '.', '_' and '-'.
std::string schedule_json(const v1::RangeSchedule& schedule) {
  const auto joined = [](const auto& ends) {
    std::string text;
    for (const std::uint32_t end : ends) text += (text.empty() ? "" : ",") + std::to_string(end);
    return "[" + text + "]";
  };
  std::string responses;
  for (const std::string& name : schedule.further_responses()) {
    responses += (responses.empty() ? "\"" : ",\"") + name + "\"";
  }
  if (!responses.empty()) responses = ",\"furtherResponses\":[" + responses + "]";
  if (schedule.photons_per_sample() != 0) {
    responses += ",\"photonsPerSample\":" + std::to_string(schedule.photons_per_sample());
  }
  if (schedule.photon_range_ends_size() != 0) {
    responses += ",\"photonRangeEnds\":" + joined(schedule.photon_range_ends());
  }
  return "{\"width\":" + std::to_string(schedule.width()) +
         ",\"height\":" + std::to_string(schedule.height()) +
         ",\"tileSize\":" + std::to_string(schedule.tile_size()) +
         ",\"rangeEnds\":" + joined(schedule.range_ends()) + responses + "}";
}

// Progress as lines "12.5 %" that end in a carriage return: a person sees one line, a program can
// split.
std::function<void(double)> progress_on_stderr(bool quiet) {
  if (quiet) return [](double) {};
  return [shown = -1](double share) mutable {
    const int permille = static_cast<int>(1000.0 * share);
    if (permille == shown) return;
    shown = permille;
    std::fprintf(stderr, "%5.1f %%%c", permille / 10.0, permille == 1000 ? '\n' : '\r');
  };
}

// What the sensor's Y is, and the units of Y and of further responses; as
// nocturne_scene/quantities.py has them.
struct Quantity {
  std::string name, unit, response_unit;
};

Quantity quantity_of(const v1::Sensor& sensor) {
  if (sensor.has_quantity()) {
    const auto& told = sensor.quantity();
    return {told.name(), told.unit(), told.response_unit()};
  }
  switch (sensor.model()) {
    case v1::SENSOR_MODEL_PLANE:
    case v1::SENSOR_MODEL_METERS:
      return {"illuminance", "lx", "W m-2"};
    case v1::SENSOR_MODEL_INTENSITY:
      return {"luminous intensity", "cd", "W sr-1"};
    default:
      return {"luminance", "cd/m2", "W m-2 sr-1"};
  }
}

// As nocturne_scene/spectra/wavelength_range.py spells them; ends are whole nm.
std::string wavelengths_of(const v1::Sensor& sensor) {
  const auto whole = [](double nm) { return std::to_string(std::lround(nm)); };
  const double first = sensor.response_first_nm();
  const double last = first + (sensor.response_y_size() - 1) * sensor.response_step_nm();
  return whole(first) + " to " + whole(last) + " nm";
}

void write_sums(const std::string& path, const TileSums& tile,
                const std::vector<double>& coefficients = {}) {
  std::ofstream file(path, std::ios::binary);
  const auto write = [&](const std::vector<double>& values) {
    file.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(double)));
  };
  for (const auto* values : tile.numbers()) write(*values);
  write(coefficients);
  finish(file, path);
}

// After each range the sums so far go to a file and their samples to standard output; a line "go"
// on standard input asks for the next range.
std::function<bool(std::uint32_t, const TileSums&)> asked_on_stdin(const std::string& path) {
  return [path](std::uint32_t samples, const TileSums& image) {
    write_sums(path, image);
    std::cout << samples << std::endl;
    std::string answer;
    return std::getline(std::cin, answer) && answer == "go";
  };
}

// One job of a service alone: its sums as float64, row by row, just as a worker sends them.
void run_job(const Options& options) {
  const auto job = read_message<v1::Job>(options.job);
  check_job(job);
  const auto message = read_message<v1::CompiledScene>(options.scene);
  const auto scene = load_scene(message, blobs_in(options.blobs));
  const auto daylight = load_daylight(message, *scene);
  const DaylightTile tile = trace_job(*scene, daylight, job);
  write_sums(options.output, tile.sums, tile.coefficients);
}

// As `nocturne_scene.render_warnings` spells them for an image's header.
std::string warning_lines(const v1::RangeSchedule& schedule) {
  std::string lines;
  for (const auto& warning : schedule.warnings()) {
    lines += (lines.empty() ? "" : "\n") + warning.sentence();
  }
  return lines;
}
std::string unmet_part_lines(const v1::RangeSchedule& schedule) {
  std::ostringstream lines;
  lines << std::setprecision(3);
  for (const auto& warning : schedule.warnings()) {
    for (const auto& part : warning.parts()) {
      lines << (lines.tellp() > 0 ? "\n" : "") << part.x() << ' ' << part.y() << ' ' << part.width()
            << ' ' << part.height() << ' ' << part.part();
    }
  }
  return lines.str();
}

// What the files of pieces are of: sums of another film, or rounded otherwise, are no part of it.
PieceFiles piece_files(const std::string& folder, const v1::RangeSchedule& schedule,
                       const std::string& scene_sha256) {
  Sha256 digest;
  digest.update(scene_sha256 + schedule.SerializeAsString() + std::to_string(v1::ENGINE_CURRENT) +
                floating_point_profile());
  return {folder, digest.hex()};
}

// Some of an image's pieces.
void run_part(const Options& options, const v1::CompiledScene& message,
              const v1::RangeSchedule& schedule) {
  const FilmPlan plan = checked_schedule(schedule);
  const FilmPart part{options.part[0], options.part[1]};
  if (part.part >= part.parts) {
    throw std::runtime_error("--part: expected K,N with 0 <= K < N");
  }
  const auto scene = load_scene(message, blobs_in(options.blobs));
  trace_part(*scene, plan, part,
             piece_files(options.output, schedule, sha256_of_file(options.scene)), options.threads,
             progress_on_stderr(options.quiet));
}

// Traced here, or joined of parts that were traced elsewhere.
std::pair<TileSums, std::uint32_t> film_of(const Options& options, const v1::CompiledScene& message,
                                           const v1::RangeSchedule& schedule, const FilmPlan& plan,
                                           const Scene* scene, const std::string& scene_sha256) {
  const auto progress = progress_on_stderr(options.quiet);
  if (!options.join.empty()) {
    const auto further = static_cast<std::size_t>(message.sensor().further_responses_size());
    return join_parts(plan, further, piece_files(options.join, schedule, scene_sha256));
  }
  if (options.sums.empty()) return trace_film(*scene, plan, options.threads, progress);
  return trace_film_by_ranges(*scene, plan, options.threads, progress,
                              asked_on_stdin(options.sums));
}

// An image, its statistics, and its warnings; `scene_sha256` goes into the image.
void run_film(const Options& options, const v1::CompiledScene& message,
              const v1::RangeSchedule& schedule, const std::string& scene_sha256) {
  const FilmPlan plan = checked_schedule(schedule);
  const auto further_responses = checked_responses(schedule, message.sensor());
  std::shared_ptr<const Scene> scene;
  if (options.join.empty()) scene = load_scene(message, blobs_in(options.blobs));

  // Loading is left out of the rates.
  const double cpu_before = process_cpu_seconds();
  const auto wall_before = std::chrono::steady_clock::now();
  const auto [image, samples] =
      film_of(options, message, schedule, plan, scene.get(), scene_sha256);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_before;
  const double cpu = process_cpu_seconds() - cpu_before;

  static const std::string profile = floating_point_profile();
  const Quantity quantity = quantity_of(message.sensor());
  write_exr(options.output, image, plan.tile_size, further_responses, samples,
            {scene_sha256, schedule_json(schedule), v1::ENGINE_CURRENT, profile, quantity.name,
             quantity.unit, quantity.response_unit, image.truncated_paths, schedule.way(),
             warning_lines(schedule), unmet_part_lines(schedule), wavelengths_of(message.sensor()),
             schedule.instruments()});
  if (!options.statistics.empty()) {
    write_statistics(options.statistics, image, cpu, wall.count());
  }
  if (image.invalid_samples > 0) {
    std::cerr << "warning: " << image.invalid_samples << " of " << image.photons
              << " samples were invalid (negative or not finite)\n";
  }
  if (image.truncated_paths > 0) {
    std::cerr << "warning: " << image.truncated_paths << " of " << image.photons
              << " photons were ended by the limit of " << PathLimits::kMaxRays
              << " interactions: the image is too dark\n";
  }
}

// What surfaces are like, as float32, row by row: see PixelLayers.
void run_layers(const Options& options, const v1::CompiledScene& message,
                const v1::RangeSchedule& schedule) {
  const FilmPlan plan = checked_schedule(schedule);
  const auto scene = load_scene(message, blobs_in(options.blobs));
  const auto layers = trace_layers(*scene, plan.film, options.layer_samples, options.threads);
  std::ofstream file(options.output, std::ios::binary);
  file.write(reinterpret_cast<const char*>(layers.data()),
             static_cast<std::streamsize>(layers.size() * sizeof(PixelLayers)));
  finish(file, options.output);
}

// What leaves the intensity meter's sphere, as float32: see LeavingRay.
void run_rays(const Options& options, const v1::CompiledScene& message) {
  const auto scene = load_scene(message, blobs_in(options.blobs));
  std::ofstream file(options.output, std::ios::binary);
  trace_rays(*scene, options.rays, options.threads, [&](std::span<const LeavingRay> rays) {
    file.write(reinterpret_cast<const char*>(rays.data()),
               static_cast<std::streamsize>(rays.size_bytes()));
  });
  finish(file, options.output);
}

// Normal and direction are null where the pixel shows no surface; of a cone its axis, and half its
// angle in degrees.
void run_learned_at(const Options& options, const v1::CompiledScene& message,
                    const v1::RangeSchedule& schedule) {
  const Film film = checked_schedule(schedule).film;
  const std::uint32_t x = options.learned_at[0], y = options.learned_at[1];
  if (x >= film.width || y >= film.height) throw std::runtime_error("the pixel is not on the film");
  const auto scene = load_scene(message, blobs_in(options.blobs));
  const auto found = learned_at(*scene, film, x, y);
  std::ofstream file(options.output);
  file.precision(6);
  const auto three = [&](Vec3 v) { file << v.x << ", " << v.y << ", " << v.z; };
  const auto vector_or_null = [&](const char* name, const Vec3* v) {
    file << '"' << name << "\": " << (v ? "[" : "null");
    if (v) three(*v);
    file << (v ? "], " : ", ");
  };
  file << '{';
  vector_or_null("normal", found ? &found->normal : nullptr);
  vector_or_null("direction", found ? &found->direction : nullptr);
  file << "\"interfaces\": " << (found ? found->passed : 0) << ", \"cones\": [";
  const auto cones = found ? found->cones : std::vector<LearnedLight::Cone>{};
  const char* separator = "";
  for (const auto& [axis, half_angle] : cones) {
    file << separator << '[';
    three(axis);
    file << ", " << half_angle * 180.0f / kPi << ']';
    separator = ", ";
  }
  file << "]}\n";
  finish(file, options.output);
}

std::string with_seed(std::string path, unsigned seed) {
  constexpr std::string_view kPlace = "{seed}";
  const auto at = path.find(kPlace);
  return at == std::string::npos ? path : path.replace(at, kPlace.size(), std::to_string(seed));
}

// One image for each seed from 1: what a program's start costs is paid once.
void run_seeds(const Options& options, v1::CompiledScene message,
               const v1::RangeSchedule& schedule) {
  if (with_seed(options.output, 1) == options.output) {
    throw std::runtime_error(options.output +
                             ": has no {seed}, so each image would replace the one before");
  }
  for (unsigned seed = 1; seed <= options.seeds; ++seed) {
    Options one = options;
    one.output = with_seed(options.output, seed);
    one.statistics = with_seed(options.statistics, seed);
    message.mutable_tracing()->set_seed(seed);
    Sha256 digest;
    digest.update(message.SerializeAsString());
    run_film(one, message, schedule, digest.hex());
  }
}

void run(const Options& options) {
  if (!options.job.empty()) return run_job(options);
  const auto message = read_message<v1::CompiledScene>(options.scene);
  const auto schedule = read_message<v1::RangeSchedule>(options.schedule);
  if (!options.pilot.empty()) {
    return run_pilot_command({options.pilot, options.blobs, options.output, options.threads},
                             message, schedule);
  }
  if (!options.part.empty()) return run_part(options, message, schedule);
  if (options.layer_samples != 0) return run_layers(options, message, schedule);
  if (options.rays != 0) return run_rays(options, message);
  if (!options.learned_at.empty()) return run_learned_at(options, message, schedule);
  if (options.daylight.divisions != 0) {
    DaylightCommand command = options.daylight;
    command.blobs = options.blobs;
    command.output = options.output;
    command.statistics = options.statistics;
    command.threads = options.threads;
    return run_daylight_command(command, message, schedule, progress_on_stderr(options.quiet));
  }
  if (options.seeds != 0) return run_seeds(options, message, schedule);
  run_film(options, message, schedule, sha256_of_file(options.scene));
}

void add_daylight_options(CLI::App& app, DaylightCommand& daylight, CLI::Option* job) {
  auto* asked = app.add_option("--daylight", daylight.divisions,
                               "Instead of an image, what patches of the sky bring to each meter "
                               "as float64; each of Tregenza's patches in N x N")
                    ->check(CLI::Range(1u, SkyPatches::kMostDivisions))
                    ->excludes(job);
  const auto direction = [&](const char* name, std::vector<float>& axis, const char* help) {
    app.add_option(name, axis, help)->delimiter(',')->expected(3)->needs(asked);
  };
  direction("--up", daylight.up, "Unit direction of the zenith, X,Y,Z");
  direction("--north", daylight.north, "Unit direction of north, X,Y,Z, across it");
  app.add_option("--suns", daylight.suns, "File of directions of suns, float64")
      ->check(CLI::ExistingFile)
      ->needs(asked);
  app.add_option("--first-sample", daylight.first_sample, "Leave out the samples before this one")
      ->needs(asked);
}

// One command line, without the program's name first; the program's status.
int run_command(std::vector<std::string> words) {
  Options options;
  CLI::App app{
      "Traces a compiled scene on this machine and writes an EXR (X, Y, Z in absolute units, "
      "Y.stderr, n, further "
      "responses).\n"
      "`nocturne compile SCENE.json -o DIR` makes DIR/scene.pb, DIR/schedule.pb and DIR/blobs.\n"
      "Ends with status 0, or with 2 and one sentence where the scene can't be read or traced.\n"
      "`nocturne-trace --commands` takes such command lines from standard input, one a line with "
      "tabs between words, and answers each with its status.",
      "nocturne-trace"};
  app.add_option("scene", options.scene, "Compiled scene (scene.pb)")
      ->required()
      ->check(CLI::ExistingFile);
  auto* what = app.add_option_group("what");
  what->add_option("--schedule", options.schedule, "Range schedule (schedule.pb)")
      ->check(CLI::ExistingFile);
  auto* job =
      what->add_option(
              "--job", options.job,
              "One job instead of an image (job.pb, from the bundle of a failed tile); its sums "
              "are written as float64")
          ->check(CLI::ExistingFile);
  what->require_option(1);
  app.add_option("--blobs", options.blobs, "Folder of meshes, textures and tables")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("-o,--output", options.output, "EXR to write, or sums")->required();
  app.add_option("--threads", options.threads, "Threads (default: all processors)")
      ->check(CLI::Range(1, 1024));
  app.add_option("--statistics", options.statistics,
                 "JSON file for photon and ray counts and times");
  app.add_option(
      "--ask-after-ranges", options.sums,
      "After each range of samples, write the sums so far to this file as float64, their "
      "number of samples to standard output, and go on only if a line \"go\" comes on "
      "standard input");
  app.add_option("--seeds", options.seeds,
                 "This many images by seeds 1, 2, ... instead of the scene's; {seed} in the names "
                 "of --output and --statistics stands for the seed")
      ->check(CLI::Range(1, 1'000'000))
      ->excludes(job);
  app.add_option(
         "--pilot", options.pilot,
         "Instead of an image, a JSON file that names the best method of tracing, of those "
         "that are open: direction (adjoint photons, or what the scene says), aim (of forward "
         "photons, as the scene says or not), learn (what to aim them at, of a scene that does not "
         "say), ratio (of forward photons to adjoint ones), guide (of adjoint photons, to where "
         "light was learned to come from), sharing; and parts (where in "
         "the image that way may miss light)")
      ->delimiter(',')
      ->check(CLI::IsMember(kPilotChooses))
      ->excludes(job);
  app.add_option("--layers", options.layer_samples,
                 "Instead of an image, what the surfaces in it are like, from this many samples of "
                 "each pixel: albedo, normal, depth, position, object, material and emission as "
                 "float32")
      ->check(CLI::Range(1, 1024))
      ->excludes(job);
  app.add_option("--rays", options.rays,
                 "Instead of an image, what leaves the intensity meter's sphere of this many "
                 "photons, as float32: place, direction, W, nm of each ray")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40))
      ->excludes(job);
  app.add_option("--learned-at", options.learned_at,
                 "Instead of an image, a JSON file that tells where light was learned to come from "
                 "at what the middle of this pixel, X,Y, shows directly or by mirrors and glass")
      ->delimiter(',')
      ->expected(2)
      ->excludes(job);
  auto* part =
      app.add_option("--part", options.part,
                     "Instead of an image, the sums of part K,N of it: of each N-th of its "
                     "pieces from the K-th on, into files in the folder --output; what is "
                     "there already is not traced again")
          ->delimiter(',')
          ->expected(2)
          ->excludes(job);
  app.add_option("--join", options.join,
                 "Traces nothing: joins the sums that --part has written into this folder")
      ->check(CLI::ExistingDirectory)
      ->excludes(job)
      ->excludes(part);
  add_daylight_options(app, options.daylight, job);
  app.add_flag("--quiet", options.quiet, "No progress");
  try {
    std::ranges::reverse(words);  // as CLI::App takes them
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  try {
    run(options);
  } catch (const std::bad_alloc&) {
    std::cerr << "nocturne-trace: there is not enough memory for this scene and film\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "nocturne-trace: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

// For many small scenes, without a start of the program for each.
void run_commands() {
  for (std::string line; std::getline(std::cin, line);) {
    std::vector<std::string> words;
    std::istringstream rest(line);
    for (std::string word; std::getline(rest, word, '\t');) words.push_back(word);
    std::cout << run_command(std::move(words)) << std::endl;
  }
}

}  // namespace
}  // namespace nocturne

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words == std::vector<std::string>{"--commands"}) {
    nocturne::run_commands();
    return 0;
  }
  return nocturne::run_command(words);
}

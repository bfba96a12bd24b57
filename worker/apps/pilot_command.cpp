#include "pilot_command.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>

#include "digest/sha256.h"
#include "trace_files.h"
#include "tracer/learning/aims_around.h"
#include "tracer/learning/gatherers.h"
#include "tracer/learning/learn.h"
#include "tracer/learning/learn_visible_sky.h"
#include "tracer/pilot/pilot.h"
#include "tracer/pilot/pilot_budget.h"
#include "tracer/pilot/sky_trial.h"

namespace nocturne {
namespace {

/// Finite, as JSON has neither infinity nor NaN: light that may be missing, over none that is seen,
/// is infinite.
double in_json(double figure) {
  constexpr double kMost = 1e9;
  return std::isnan(figure) ? 0.0 : std::clamp(figure, -kMost, kMost);
}

std::string figures_json(const PilotFigures& figures) {
  static constexpr const char* kNames[] = {"adjoint", "adjoint_of_both", "forward"};
  const PhotonKind& kind = figures.kind;
  std::ostringstream json;
  json.precision(6);
  json << "{\"photons\": \"" << kNames[kind.from] << "\", \"sharing\": " << kind.sharing
       << ", \"aimed\": " << kind.aimed << ", \"guided\": " << (kind.guided ? "true" : "false")
       << ", \"mean\": " << in_json(figures.mean)
       << ", \"mean_error\": " << in_json(figures.mean_error)
       << ", \"relative_mse\": " << in_json(figures.relative_mse)
       << ", \"cost\": " << in_json(figures.cost) << '}';
  return json.str();
}

std::string parts_json(const std::vector<UnmetPart>& parts) {
  std::ostringstream json;
  json.precision(3);
  for (const UnmetPart& each : parts) {
    json << (json.view().empty() ? "" : ", ") << '[' << each.x << ", " << each.y << ", "
         << each.width << ", " << each.height << ", " << in_json(each.part) << ']';
  }
  return json.str();
}

const char* fault_name(PilotResult::Fault fault) {
  switch (fault) {
    case PilotResult::Fault::kGuided:
      return "guided";
    case PilotResult::Fault::kShared:
      return "shared";
    case PilotResult::Fault::kNone:
      break;
  }
  return "";
}

std::string aims_json(const std::vector<Aim>& aims) {
  std::ostringstream json;
  json.precision(17);
  for (const Aim& aim : aims) {
    json << (&aim == aims.data() ? "" : ", ") << "{\"centre\": [" << aim.centre.x << ", "
         << aim.centre.y << ", " << aim.centre.z << "], \"radius\": " << aim.radius
         << ", \"weight\": " << aim.weight << '}';
  }
  return '[' + json.str() + ']';
}

// Part of a render's samples from which aims are learned, and light to guide photons by: at least
// so many, and at most as many as are enough to find what a thousandth of the photons is worth.
constexpr double kLearnedFrom = 0.005, kMinLearnedFrom = 1e4, kMaxLearnedFrom = 3e5;
// Part of the photons that are then aimed; the others leave as luminaires emit, and their hits
// weighs 2.5 times as much (docs/decisions/0130).
constexpr double kAimed = 0.6;

// Part of a render's samples from which the visible sky is learned; with four times as many the
// living room of bench/real had 1.1 times the efficiency.
constexpr double kSkyLearnedFrom = 0.02, kMaxSkyLearnedFrom = 1e5;

double samples_of(const FilmPlan& plan) {
  return 1.0 * plan.film.width * plan.film.height * static_cast<double>(plan.samples());
}

double training_samples(const FilmPlan& plan) {
  return std::clamp(kLearnedFrom * samples_of(plan), kMinLearnedFrom, kMaxLearnedFrom);
}

// Has the scene loaded again, as with important shapes that a person declared.
void aim_at(const std::vector<Aim>& aims, const PilotCommand& command, v1::CompiledScene& message,
            std::shared_ptr<Scene>& scene) {
  for (const Aim& aim : aims) {
    v1::ImportantShape& shape = *message.add_important_shapes();
    v1::Sphere& sphere = *shape.mutable_sphere();
    sphere.mutable_centre()->set_x(static_cast<double>(aim.centre.x));
    sphere.mutable_centre()->set_y(static_cast<double>(aim.centre.y));
    sphere.mutable_centre()->set_z(static_cast<double>(aim.centre.z));
    sphere.set_radius(static_cast<double>(aim.radius));
    shape.set_weight(aim.weight);
  }
  message.mutable_tracing()->set_aimed_emission(kAimed);
  scene = load_scene(message, blobs_in(command.blobs));
}

}  // namespace

void run_pilot_command(const PilotCommand& command, v1::CompiledScene message,
                       const v1::RangeSchedule& schedule) {
  const FilmPlan plan = checked_schedule(schedule);
  auto scene = load_scene(message, blobs_in(command.blobs));
  check_that_samples_end(*scene, plan.film, command.threads);
  const auto open = [&](const char* what) { return std::ranges::count(command.open, what) > 0; };
  const double cpu_before = process_cpu_seconds(), photons = training_samples(plan);
  Learned learned;
  if (open("learn") || open("guide")) {
    learned = learn(*scene, plan.film, photons, command.threads);
  }
  std::vector<Aim> aims;
  if (open("learn")) aims = aims_around(learned.worth_aiming_at);
  if (open("learn") && aims.empty() && scene->options.direction == Direction::kBoth) {
    // A ball of glass on a wide ground is met too rarely to be learned.
    aims = aims_around(places_on_gatherers(*scene, [&](std::uint32_t surface) {
      return message.surfaces(static_cast<int>(surface)).group();
    }));
  }
  if (!aims.empty()) aim_at(aims, command, message, scene);
  std::string learned_light;
  if (open("guide")) {
    learned_light = LearnedLight::packed(learned.arrivals);
    scene->lights.set_learned(LearnedLight(LearnedLight::unpacked(learned_light)));
  }
  LearnedSky sky;
  if (open("sky")) {
    const double samples = std::min(kSkyLearnedFrom * samples_of(plan), kMaxSkyLearnedFrom);
    sky = learn_visible_sky(*scene, plan.film, samples, command.threads);
  }
  std::string visible_sky = VisibleSky::packed(sky.sightings);
  if (!visible_sky.empty()) {
    const SkyTrial trial =
        try_visible_sky(*scene, VisibleSky(VisibleSky::unpacked(visible_sky)), plan.film,
                        static_cast<double>(sky.samples), command.threads);
    sky.samples += trial.samples;
    if (!trial.pays) visible_sky.clear();
  }
  const PilotResult found = run_pilot(
      *scene,
      {.film = plan.film,
       .samples = plan.samples(),
       .direction = open("direction"),
       .aim = open("aim") || !aims.empty(),
       .sharing = open("sharing"),
       .ratio = open("ratio"),
       .guide = !scene->lights.learned().empty(),
       .parts = open("parts"),
       .training_samples = (learned.rays > 0 ? photons : 0.0) + static_cast<double>(sky.samples),
       .threads = command.threads});
  std::string tried;
  for (const PilotFigures& figures : found.tried) {
    tried += (tried.empty() ? "" : ", ") + figures_json(figures);
  }
  std::ofstream file(command.output);
  file.precision(6);
  file << "{\"forward_photons\": "
       << (found.choice.direction != Direction::kAdjoint ? "true" : "false")
       << ", \"aimed\": " << found.choice.aimed
       << ", \"aims\": " << aims_json(found.choice.aimed > 0.0f ? aims : std::vector<Aim>{})
       << ", \"learned_light\": \"" << (found.choice.guided ? to_hex(learned_light) : "") << '"'
       << ", \"visible_sky\": \"" << to_hex(visible_sky) << '"'
       << ", \"sharing\": " << found.choice.sharing
       << ", \"forward_ratio\": " << found.choice.forward_ratio
       << ", \"gain\": " << in_json(found.choice.gain)
       << ", \"gain_error\": " << in_json(found.choice.gain_error)
       << ", \"unmet\": " << in_json(found.unmet) << ", \"fault\": \"" << fault_name(found.fault)
       << "\", \"differs_by\": " << in_json(found.differs_by) << ", \"unmet_parts\": ["
       << parts_json(found.unmet_parts) << ']'
       << ", \"finds_more\": " << (found.choice.finds_more ? "true" : "false")
       << ", \"photons\": " << found.photons + learned.photons
       << ", \"rays\": " << found.rays + learned.rays
       << ", \"cpu_seconds\": " << process_cpu_seconds() - cpu_before << ", \"tried\": [" << tried
       << "]}\n";
  finish(file, command.output);
}

}  // namespace nocturne

#include "scene/load_scene.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "digest/sha256.h"
#include "scene/bodies_around.h"
#include "scene/contacts.h"
#include "scene/load_context.h"
#include "scene/load_kernels.h"
#include "scene/load_lights.h"
#include "scene/load_media.h"
#include "scene/load_sensor.h"
#include "scene/load_special_kernels.h"
#include "scene/load_surfaces.h"
#include "scene/load_textures.h"
#include "scene/places.h"
#include "scene/sensor_extents.h"

namespace nocturne {
namespace {

/// Of scenes whose responses count parts of the light, which programs before it would not see.
constexpr std::uint32_t kFormat = 3, kFormatWithRange = 7, kLatestFormat = 11;
// nm, where a scene's wavelengths may lie.
constexpr double kShortest = 200.0, kLongest = 2500.0;
// Of one spectrum, so that a scene's size says how much work it makes.
constexpr int kMaxLines = 10'000;

Lines load_lines(const v1::Spectrum& message) {
  require(message.lines_size() <= kMaxLines, "a spectrum with more than 10000 lines");
  std::vector<Line> lines;
  for (const auto& line : message.lines()) {
    lines.push_back({finite(line.centre_nm(), "a line's centre"),
                     finite(line.power(), "a line's power"),
                     finite(line.width_nm(), "a line's width")});
  }
  return checked([&] { return Lines(lines); });
}

Spectrum load_table(const v1::Spectrum& message) {
  require(message.values_size() > 0, "a spectrum without values");
  for (const float value : message.values()) {
    require(std::isfinite(value) && value >= 0.0f, "a spectrum with a negative or infinite value");
  }
  if (message.values_size() == 1) return Spectrum(message.values(0));
  require(message.step_nm() > 0.0, "a spectrum without a step");
  return Spectrum(finite(message.first_nm(), "a wavelength"),
                  finite(message.step_nm(), "a wavelength step"),
                  {message.values().begin(), message.values().end()}, message.zero_outside());
}

Spectrum load_spectrum(const v1::Spectrum& message) {
  return {load_table(message), load_lines(message)};
}

// What the sensor sees are the wavelengths of its responses.
void set_seen(const v1::Sensor& s, std::vector<Spectrum>& spectra) {
  const double first = finite(s.response_first_nm(), "a wavelength");
  const double step = finite(s.response_step_nm(), "a wavelength step");
  const double last = first + step * (s.response_y_size() - 1);
  require(kShortest <= first && first < last && last <= kLongest,
          "wavelengths beyond 200 to 2500 nm");
  for (Spectrum& spectrum : spectra) {
    spectrum.set_seen(static_cast<float>(first), static_cast<float>(last));
  }
}

LoadContext make_context(const v1::CompiledScene& message, const FindBlob& find_blob,
                         std::stop_token stop) {
  if (message.format() < kFormat || message.format() > kLatestFormat) {
    refuse("format " + std::to_string(message.format()) + "; this program reads formats " +
           std::to_string(kFormat) + " to " + std::to_string(kLatestFormat));
  }
  LoadContext context{message, find_blob, stop, {}, {}, {}};
  for (const auto& s : message.spectra()) context.spectra.push_back(load_spectrum(s));
  // Of other scenes they are 360 to 830 nm.
  if (message.format() >= kFormatWithRange) set_seen(message.sensor(), context.spectra);
  context.textures = load_textures(message, find_blob);
  if (message.has_rgb_table()) context.rgb_spectra = load_rgb_table(message.rgb_table(), find_blob);
  return context;
}

// Without anything to point at, the weight of lights goes to the kernel.
MixtureWeights load_mixture(const v1::Tracing& t, bool no_lights) {
  double kernel = t.weight_kernel();
  double lights = t.weight_luminaires() + t.weight_environment() + t.weight_important();
  const double uniform = t.weight_uniform();
  for (const double weight :
       {kernel, t.weight_luminaires(), t.weight_environment(), t.weight_important(), uniform}) {
    require(weight >= 0.0, "a mixture weight that is negative");
  }
  require(std::fabs(kernel + lights + uniform - 1.0) < 1e-6,
          "mixture weights that don't add up to 1");
  if (no_lights) {
    kernel += lights;
    lights = 0.0;
  }
  return {static_cast<float>(kernel), static_cast<float>(lights), static_cast<float>(uniform)};
}

Estimator load_estimator(const v1::Tracing& t) {
  switch (t.estimator()) {
    case v1::ESTIMATOR_MIXTURE:
      return Estimator::kMixture;
    case v1::ESTIMATOR_SPLIT:
      return Estimator::kSplit;
    case v1::ESTIMATOR_TWO_PHOTONS:
      return Estimator::kTwoPhotons;
    default:
      refuse("an estimator that this program doesn't know");
  }
}

Direction load_direction(const v1::Tracing& t) {
  switch (t.direction()) {
    case v1::DIRECTION_ADJOINT:
      return Direction::kAdjoint;
    case v1::DIRECTION_FORWARD:
      return Direction::kForward;
    case v1::DIRECTION_BOTH:
      return Direction::kBoth;
    default:
      refuse("a direction that this program doesn't know");
  }
}

TracingOptions load_tracing(const v1::Tracing& t, bool no_lights) {
  require(t.h() > 0.0 && std::isfinite(t.h()), "h is not positive");
  require(
      t.sequence() == v1::SAMPLE_SEQUENCE_SOBOL || t.sequence() == v1::SAMPLE_SEQUENCE_INDEPENDENT,
      "a sample sequence that this program doesn't know");
  require(t.roulette() == v1::ROULETTE_WEIGHT || t.roulette() == v1::ROULETTE_ALBEDO,
          "a roulette that this program doesn't know");
  require(t.split_vertices() <= TracingOptions::kMaxSplitVertices,
          "more than 8 vertices that split");
  require(t.group() == 1 || t.group() == 4, "a group of photons that is not 1 or 4");
  const std::uint32_t sharing = std::max(1u, t.sharing());
  require(sharing == 1 || sharing == 16, "a block of pixels that share which is not 1 or 16");
  // Without others, light that takes another path from the luminaires would be lost.
  require(t.aimed_emission() >= 0.0 && t.aimed_emission() <= 0.99,
          "a part of aimed photons beyond 0 to 0.99");
  require(t.forward_ratio() == 0.0 || (t.forward_ratio() >= 1.0 / 16 && t.forward_ratio() <= 64.0),
          "a ratio of forward photons beyond 1/16 to 64");
  return {
      static_cast<float>(t.h()),
      t.roulette() == v1::ROULETTE_WEIGHT,
      t.roulette_after(),
      t.maximum_depth() == 0 ? std::numeric_limits<std::uint32_t>::max() : t.maximum_depth(),
      load_mixture(t, no_lights),
      load_estimator(t),
      t.split_vertices(),
      t.group(),
      sharing,
      load_direction(t),
      static_cast<float>(t.aimed_emission()),
      t.forward_ratio() == 0.0 ? 1.0 : t.forward_ratio(),
      t.sequence() == v1::SAMPLE_SEQUENCE_SOBOL ? SequenceKind::kSobol : SequenceKind::kIndependent,
      t.seed()};
}

// Of a lamp's intensity, photons start around it.
Vec3 sensor_start(const v1::Sensor& s) {
  const Vec3 position = vector(s.position(), "the sensor's position");
  if (s.model() != v1::SENSOR_MODEL_INTENSITY) return position;
  return position + 1.001f * finite(s.lamp_radius(), "the lamp's radius") *
                        vector(s.forward(), "the sensor's forward");
}

// Of the distance to what the camera sees, or of the scene's radius if that is less. Photons from
// luminaires that are spread near a camera count by one over the square of their distance, which in
// fog has no variance.
constexpr float kNearEnds = 0.05f;

bool fills_space_evenly(const Medium& medium) {
  return std::holds_alternative<ConstantDensity>(medium.density) && medium.scattering.most() > 0.0f;
}

// Photons can wander through it without limit. It hides all distant light; a glow would be
// everywhere.
bool in_fog_without_end(const InteriorList& everywhere, const std::vector<Interior>& interiors,
                        const std::vector<Medium>& media) {
  bool even = false, glows = false;
  everywhere.for_each_present(interiors, [&](const Interior& body) {
    for (const std::uint32_t medium : body.media) {
      even = even || fills_space_evenly(media[medium]);
      glows = glows || media[medium].glow;
    }
  });
  return even && !glows;
}

std::optional<Geometry::Ball> find_all_in_fog(const Geometry& geometry, Vec3 sensor,
                                              const InteriorList& everywhere,
                                              const std::vector<Interior>& interiors,
                                              const std::vector<Medium>& media) {
  if (!in_fog_without_end(everywhere, interiors, media)) return std::nullopt;
  if (geometry.shapes().empty()) return Geometry::Ball{sensor, 0.0f};
  Geometry::Ball ball = geometry.bounds();
  ball.radius = std::max(ball.radius, length(sensor - ball.centre));
  return ball;
}

// Marks surfaces that are close together, for the searches and for the handling of a hit.
void set_close(Geometry& geometry, const std::vector<std::uint32_t>& groups, Vec3 sensor,
               const std::vector<Interior>& interiors, std::vector<SurfaceMaterial>& materials) {
  const Geometry::Ball ball = geometry.bounds();
  std::vector<CloseSurface> close = find_close(geometry, groups, materials, interiors,
                                               2.0f * ball.radius + length(sensor - ball.centre));
  for (std::size_t i = 0; i < close.size(); ++i) materials[i].close = close[i].reach > 0.0f;
  geometry.set_close(std::move(close));
}

// Unscattered. What only mirrors it does not.
bool lets_light_through(const SurfaceMaterial& material) {
  return material.has_delta_lobe && material.may_pass;
}

bool shadow_rays_suffice(const TracingOptions& options,
                         const std::vector<SurfaceMaterial>& materials,
                         const std::vector<Interior>& interiors, const LightSampler& lights,
                         const std::vector<Luminaire>& luminaires,
                         const std::vector<std::uint32_t>& groups) {
  return options.estimator == Estimator::kTwoPhotons && options.direction != Direction::kForward &&
         interiors.empty() && !lights.points_at_important() &&
         std::ranges::none_of(materials, lets_light_through) &&
         std::ranges::none_of(materials, &SurfaceMaterial::close) &&
         std::ranges::none_of(luminaires, [&](const Luminaire& luminaire) {
           return luminaire.textured() || groups[luminaire.surface] != 0;
         });
}

// Around all surfaces that may keep light together; empty where there are none.
std::optional<Geometry::Ball> ball_of_gatherers(const Geometry& geometry,
                                                const std::vector<std::uint32_t>& groups,
                                                const std::vector<SurfaceMaterial>& materials,
                                                const std::vector<AnyKernel>& kernels,
                                                const std::vector<bool>& specular_like) {
  const auto gathers = [&](std::uint32_t kernel) {
    return specular_like[kernel] || may_turn_sharply(kernels, kernel);
  };
  Box box;
  const auto shapes = geometry.shapes();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!gathers(materials[i].front_kernel) && !gathers(materials[i].back_kernel)) continue;
    for_each_place(geometry, groups[i], [&](const PlacedInstance* instance) {
      box.add(whole_box_of(shapes[i], instance));
    });
  }
  if (!(box.low.x <= box.high.x)) return std::nullopt;
  // What single precision rounds off a start far away stays within.
  const Geometry::Ball all = geometry.bounds();
  constexpr float kRounding = 0x1p-20f;
  const Geometry::Ball ball{box.middle(), 0.5f * length(box.high - box.low) +
                                              kRounding * (all.radius + max_abs(all.centre))};
  return ball.radius < all.radius ? std::optional(ball) : std::nullopt;
}

}  // namespace

std::string blob_name(const std::string& sha256) {
  require(sha256.size() == 32, "a blob that is not named by a SHA-256");
  return to_hex(sha256);
}

std::shared_ptr<Scene> load_scene(const v1::CompiledScene& message, const FindBlob& find_blob,
                                  std::stop_token stop) {
  const FindBlob find_or_stop = [&](const std::string& sha256) {
    throw_if_stopped(stop);
    return find_blob(sha256);
  };
  const LoadContext context = make_context(message, find_or_stop, stop);
  auto kernels = load_kernels(context);
  LoadedShapes loaded = load_shapes(context);
  auto materials = load_materials(context, kernels, loaded.shapes);
  auto interiors = load_interiors(context);
  const InteriorList everywhere = load_unbounded(context);
  set_closed(loaded.shapes, materials, everywhere, interiors);
  return checked([&] {
    Geometry geometry(std::move(loaded.shapes), loaded.groups, std::move(loaded.instances), stop);
    auto luminaires = load_luminaires(context, geometry, materials);
    throw_if_stopped(stop);
    set_close(geometry, loaded.groups, sensor_start(message.sensor()), interiors, materials);
    throw_if_stopped(stop);
    auto media = load_media(context, kernels, materials);
    throw_if_stopped(stop);
    auto lights = load_light_sampler(context, luminaires, geometry, loaded.groups);
    const TracingOptions options = load_tracing(message.tracing(), lights.empty());
    const bool polarised = is_polarised(message.sensor(), kernels);
    check_special_kernels(kernels, polarised, options);
    auto sensor = load_sensor(message.sensor());
    const Bodies bodies{geometry, materials, interiors, everywhere};
    const SensorSurroundings sensor_around =
        sensor_surroundings(bodies, loaded.groups, sensor, sensor_start(message.sensor()));
    auto specular_like = load_specular_like(message, kernels);
    PhotonEmitter emitter;
    std::vector<LuminaireSurroundings> luminaires_around;
    if (options.direction == Direction::kForward) {
      require(sensor.splats_segments() || sensor.receives_escapes(),
              "forward photons need a plane or an intensity sensor");
      // The counts of a sensor on the path must not depend on where photons beyond it went.
      require(media.empty() || options.group == 1, "forward photons in groups through media");
    } else if (options.direction == Direction::kBoth) {
      require(sensor.is_camera(), "photons in both directions need a camera");
    }
    require(message.ray_sets().empty() || options.direction == Direction::kForward,
            "rays of a file, which only photons from the luminaires carry");
    if (options.direction != Direction::kAdjoint) {
      const bool distant = lights.environment() || !lights.discs().empty();
      require(!distant || everywhere.empty(),
              "photons of distant light, which can't start in unbounded media");
      emitter = load_emitter(
          context, luminaires, lights, geometry, loaded.groups, sensor,
          options.direction == Direction::kBoth
              ? ball_of_gatherers(geometry, loaded.groups, materials, kernels, specular_like)
              : std::nullopt);
      luminaires_around = luminaire_surroundings(bodies, loaded.groups, luminaires);
    }
    bool has_mirrors = std::ranges::find(specular_like, true) != specular_like.end();
    for (std::uint32_t i = 0; i < kernels.size(); ++i) {
      has_mirrors = has_mirrors || may_turn_sharply(kernels, i);
    }
    const float near_ends = options.direction == Direction::kBoth
                                ? kNearEnds * std::min(geometry.bounds().radius,
                                                       median_view(sensor, geometry, materials))
                                : 0.0f;
    const auto all_in_fog =
        find_all_in_fog(geometry, sensor_start(message.sensor()), everywhere, interiors, media);
    LearnedLight learned(LearnedLight::unpacked(message.learned_light()));
    const bool occlusion = media.empty() && shadow_rays_suffice(options, materials, interiors,
                                                                lights, luminaires, loaded.groups);
    lights.set_learned(std::move(learned));
    lights.set_visible_sky(VisibleSky(VisibleSky::unpacked(message.visible_sky())));
    return std::shared_ptr<Scene>(new Scene{std::move(geometry),
                                            std::move(materials),
                                            std::move(kernels),
                                            std::move(interiors),
                                            std::move(media),
                                            load_bump_maps(context),
                                            std::move(luminaires),
                                            std::move(lights),
                                            std::move(emitter),
                                            std::move(sensor),
                                            load_wavelengths(message.sensor()),
                                            options,
                                            everywhere,
                                            sensor_around,
                                            std::move(luminaires_around),
                                            occlusion,
                                            all_in_fog,
                                            std::move(specular_like),
                                            has_mirrors,
                                            near_ends,
                                            {},
                                            polarised});
  });
}

}  // namespace nocturne

#include "scene/load_lights.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "scene/blob_file.h"
#include "scene/bodies_around.h"
#include "scene/load_kernels.h"
#include "scene/load_mesh.h"
#include "scene/load_surfaces.h"
#include "scene/load_textures.h"
#include "scene/places.h"
#include "scene/sensor_extents.h"
#include "surfaces/sphere_intersection.h"
#include "surfaces/triangle_at.h"

namespace nocturne {
namespace {

// Of a texture: finite.
constexpr float kMaxRadiance = std::numeric_limits<float>::max();

// Steps of the shape or of the instance, whichever are more: directions drawn towards it need not
// follow a motion that is the product of two to the last digit.
std::size_t time_steps(const Shape& shape, const PlacedInstance* instance) {
  const std::size_t own = time_steps_of(shape);
  return instance ? std::max(own, instance->time_steps()) : own;
}

float time_of(std::size_t step, std::size_t steps) {
  return steps == 1 ? 0.0f : static_cast<float>(step) / static_cast<float>(steps - 1);
}

// All vertices at each time step, in the scene.
std::vector<std::vector<Vec3>> placed_vertices(const TriangleMesh& mesh,
                                               const PlacedInstance* instance, std::size_t steps) {
  std::vector<std::vector<Vec3>> all(steps);
  for (std::size_t step = 0; step < steps; ++step) {
    const float time = time_of(step, steps);
    for (std::size_t i = 0; i < mesh.vertex_count(); ++i) {
      const Vec3 vertex = mesh.time_steps == 1 ? mesh.vertices[i]
                                               : vertex_at(mesh, mesh.vertices,
                                                           segment_at(time, mesh.time_steps), i);
      all[step].push_back(placed(instance, time, vertex));
    }
  }
  return all;
}

std::vector<Sphere> placed_spheres(const Sphere& sphere, const PlacedInstance* instance,
                                   std::size_t steps) {
  std::vector<Sphere> all;
  for (std::size_t step = 0; step < steps; ++step) {
    const float time = time_of(step, steps);
    const Double3 centre = centre_at(sphere, time);
    if (instance == nullptr) {
      all.push_back({centre.x, centre.y, centre.z, sphere.radius});
      continue;
    }
    const Placement placement = instance->placement(time);
    const Double3 c = placement.point_to_scene(centre);
    all.push_back({c.x, c.y, c.z, sphere.radius * placement.largest_stretch()});
  }
  return all;
}

AngularProfile load_profile(const v1::Luminaire& message, const Shape& shape, bool instanced) {
  if (message.has_cosine_power()) {
    return CosinePowerProfile{finite(message.cosine_power(), "a cosine power")};
  }
  if (!message.has_intensity()) return LambertianProfile{};
  require(!instanced, "an intensity profile on an instanced surface");
  const v1::IntensityProfile& p = message.intensity();
  const auto floats = [](const auto& values) {
    return std::vector<float>(values.begin(), values.end());
  };
  IntensityProfile profile({vector(p.axis(), "a profile's axis"),
                            vector(p.zero(), "a profile's zero direction"), floats(p.vertical()),
                            floats(p.horizontal()), floats(p.values())});
  const auto of_mesh = [&](const TriangleMesh& mesh) {
    double area = 0.0;
    for (const auto& t : mesh.triangles) {
      area += 0.5 * length(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]],
                                 mesh.vertices[t[2]] - mesh.vertices[t[0]]));
    }
    return IntensityLamp{std::move(profile), static_cast<float>(area), true};
  };
  return visit_shape(shape, of_mesh, [&](const Sphere& sphere) {
    const double disc = std::numbers::pi * sphere.radius * sphere.radius;
    return IntensityLamp{std::move(profile), static_cast<float>(disc), false};
  });
}

Elements luminaire_elements(const std::vector<Luminaire>& luminaires, const Geometry& geometry,
                            const std::vector<std::uint32_t>& groups) {
  Elements elements;
  for (std::uint32_t i = 0; i < luminaires.size(); ++i) {
    const Luminaire& luminaire = luminaires[i];
    const Shape& shape = geometry.shapes()[luminaire.surface];
    Emission emission = luminaire.emission();
    emission.luminaire = i;
    for_each_place(geometry, groups[luminaire.surface], [&](const PlacedInstance* instance) {
      const std::size_t steps = time_steps(shape, instance);
      const auto add_mesh = [&](const TriangleMesh& mesh) {
        const auto vertices = placed_vertices(mesh, instance, steps);
        const std::vector<std::span<const Vec3>> spans(vertices.begin(), vertices.end());
        elements.add_mesh(spans, mesh.triangles, emission);
      };
      visit_shape(shape, add_mesh, [&](const Sphere& sphere) {
        elements.add_sphere(placed_spheres(sphere, instance, steps), emission);
      });
    });
  }
  return elements;
}

Elements important_elements(const LoadContext& context) {
  Elements elements;
  for (const auto& important : context.message.important_shapes()) {
    const std::size_t first = elements.size();
    const Emission emission{.radiance = 1.0f, .two_sided = true};
    if (important.has_sphere()) {
      const std::vector<Sphere> spheres{load_sphere(important.sphere())};
      elements.add_sphere(spheres, emission);
    } else {
      require(important.has_quad() || important.has_mesh(),
              "an important shape that this program doesn't know");
      const TriangleMesh mesh = important.has_quad()
                                    ? load_quad(important.quad())
                                    : load_mesh(important.mesh(), context.find_blob);
      const std::vector<std::span<const Vec3>> vertices{
          std::span(mesh.vertices).first(mesh.vertex_count())};
      elements.add_mesh(vertices, mesh.triangles, emission);
    }
    require(important.weight() > 0.0 && std::isfinite(important.weight()),
            "an important shape without a weight");
    elements.share_weight(first, important.weight());
  }
  return elements;
}

HiddenFrom load_hidden_from(v1::HiddenFrom message) {
  switch (message) {
    case v1::HIDDEN_FROM_NOBODY:
      return HiddenFrom::kNobody;
    case v1::HIDDEN_FROM_CAMERA:
      return HiddenFrom::kCamera;
    case v1::HIDDEN_FROM_CAMERA_AND_MIRRORS:
      return HiddenFrom::kCameraAndMirrors;
    default:
      refuse("a light hidden from somebody that this program doesn't know");
  }
}

EnvironmentMap load_map(const LoadContext& context, const v1::EnvironmentMap& message) {
  require(message.columns() > 0 && message.columns() <= EnvironmentMap::kMaxColumns &&
              message.rows() > 0 && message.rows() <= EnvironmentMap::kMaxRows,
          "an environment map without texels or with too many");
  const std::size_t count = std::size_t{message.columns()} * message.rows();
  BlobFile file(context.find_blob, message.blob(), "an environment map");
  require(file.size() == count * sizeof(EnvironmentMap::Texel),
          "an environment map of another length than its size says");
  auto texels = file.read<EnvironmentMap::Texel>(count);
  return EnvironmentMap(message.columns(), message.rows(), std::move(texels),
                        context.spectrum(message.spectrum()),
                        {vector(message.x(), "a map's axis"), vector(message.y(), "a map's axis"),
                         vector(message.z(), "a map's axis")});
}

// Light groups that are told apart; each has a response, or none has.
std::uint32_t groups_told_apart(const LoadContext& context) {
  std::uint32_t groups = 0;
  for (const auto& response : context.message.sensor().further_responses()) {
    if (response.has_light_group()) groups = std::max(groups, response.light_group() + 1);
  }
  return groups;
}

std::uint32_t load_light_group(const LoadContext& context, std::uint32_t number) {
  const std::uint32_t groups = groups_told_apart(context);
  require(groups == 0 || number < groups, "a light group that no response counts");
  return number;
}

std::optional<Environment> load_environment(const LoadContext& context) {
  if (!context.message.has_environment()) return std::nullopt;
  const v1::Environment& message = context.message.environment();
  Environment environment = message.has_map() ? Environment(load_map(context, message.map()))
                                              : Environment(context.spectrum(message.constant()));
  environment.hidden_from = load_hidden_from(message.hidden_from());
  environment.light_group = load_light_group(context, message.light_group());
  return environment;
}

std::vector<DistantDisc> load_discs(const LoadContext& context) {
  std::vector<DistantDisc> discs;
  for (const auto& disc : context.message.distant_discs()) {
    DistantDisc::LimbDarkening limb;
    for (const std::uint32_t index : disc.limb_plus()) {
      limb.plus.push_back(context.spectrum(index));
    }
    for (const std::uint32_t index : disc.limb_minus()) {
      limb.minus.push_back(context.spectrum(index));
    }
    discs.emplace_back(vector(disc.direction(), "a disc's direction"), disc.half_angle(),
                       context.spectrum(disc.radiance()), std::move(limb));
    discs.back().hidden_from = load_hidden_from(disc.hidden_from());
    discs.back().light_group = load_light_group(context, disc.light_group());
  }
  return discs;
}

RaySet load_rays(const LoadContext& context, const v1::RaySet& message) {
  BlobFile file(context.find_blob, message.blob(), "a set of rays");
  require(message.count() > 0 && file.size() == message.count() * sizeof(RaySet::Recorded),
          "a set of rays of another length than its count says");
  return checked([&] {
    return RaySet(file.read<RaySet::Recorded>(message.count()),
                  context.spectrum(message.spectrum()),
                  load_light_group(context, message.light_group()));
  });
}

}  // namespace

std::vector<Luminaire> load_luminaires(const LoadContext& context, const Geometry& geometry,
                                       std::vector<SurfaceMaterial>& materials) {
  std::vector<Luminaire> luminaires;
  for (const auto& message : context.message.luminaires()) {
    require(message.surface() < materials.size(), "a luminaire on a surface that is not there");
    SurfaceMaterial& material = materials[message.surface()];
    require(material.luminaire == SurfaceMaterial::kNone, "a surface with two luminaires");
    material.luminaire = static_cast<std::uint32_t>(luminaires.size());
    const bool instanced =
        context.message.surfaces(static_cast<int>(message.surface())).group() != 0;
    luminaires.push_back(checked([&] {
      return Luminaire(message.surface(), load_colour(context, message.radiance(), kMaxRadiance),
                       message.two_sided(),
                       load_profile(message, geometry.shapes()[message.surface()], instanced));
    }));
    luminaires.back().hidden_from = load_hidden_from(message.hidden_from());
    luminaires.back().light_group = load_light_group(context, message.light_group());
  }
  return luminaires;
}

LightSampler load_light_sampler(const LoadContext& context,
                                const std::vector<Luminaire>& luminaires, const Geometry& geometry,
                                const std::vector<std::uint32_t>& groups) {
  const v1::Tracing& t = context.message.tracing();
  return checked([&] {
    return LightSampler(
        luminaire_elements(luminaires, geometry, groups), load_environment(context),
        load_discs(context), important_elements(context),
        {static_cast<float>(t.weight_luminaires()), static_cast<float>(t.weight_environment()),
         static_cast<float>(t.weight_important())});
  });
}

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

PhotonEmitter load_emitter(const LoadContext& context, const std::vector<Luminaire>& luminaires,
                           const LightSampler& lights, const Geometry& geometry,
                           const std::vector<std::uint32_t>& groups, const Sensor& sensor,
                           std::optional<Geometry::Ball> gathering) {
  PhotonEmitter emitter;
  for (std::uint32_t i = 0; i < luminaires.size(); ++i) {
    const Luminaire& luminaire = luminaires[i];
    const Shape& shape = geometry.shapes()[luminaire.surface];
    for_each_place(geometry, groups[luminaire.surface], [&](const PlacedInstance* instance) {
      const std::uint32_t placed_shape = index_of(geometry, instance);
      const auto add_mesh = [&](const TriangleMesh& mesh) {
        const auto vertices = placed_vertices(mesh, instance, time_steps(shape, instance));
        for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
          const auto& t = mesh.triangles[triangle];
          std::vector<std::array<Vec3, 3>> corners;
          for (const auto& v : vertices) corners.push_back({v[t[0]], v[t[1]], v[t[2]]});
          emitter.add_triangle(i, luminaire, std::move(corners), {placed_shape, triangle});
        }
      };
      visit_shape(shape, add_mesh, [&](const Sphere& sphere) {
        emitter.add_sphere(i, luminaire, sphere, geometry, placed_shape);
      });
    });
  }
  for (const auto& message : context.message.ray_sets()) {
    emitter.add_rays(load_rays(context, message));
  }
  emitter.finish(lights, ball_with_film(geometry.bounds(), sensor, {1, 1}),
                 groups_told_apart(context) > 0, gathering);
  return emitter;
}

}  // namespace nocturne

#include "scene/load_surfaces.h"

#include "scene/load_kernels.h"
#include "scene/load_mesh.h"
#include "scene/load_textures.h"
#include "surfaces/closed.h"

namespace nocturne {
namespace {

constexpr int kTransformSize = 12;

Shape load_shape(const LoadContext& context, const v1::Surface& surface) {
  switch (surface.shape_case()) {
    case v1::Surface::kMesh:
      return load_mesh(surface.mesh(), context.find_blob);
    case v1::Surface::kSphere:
      return load_sphere(surface.sphere());
    case v1::Surface::kQuad:
      return load_quad(surface.quad());
    case v1::Surface::SHAPE_NOT_SET:
      break;
  }
  refuse("a surface of a shape that this program doesn't know");
}

Instance load_instance(const v1::Instance& message) {
  require(message.transforms_size() > 0 && message.transforms_size() % kTransformSize == 0,
          "an instance whose transforms are not 12 numbers each");
  Instance instance{message.group(), {}};
  for (int step = 0; step < message.transforms_size(); step += kTransformSize) {
    Transform transform;
    for (int i = 0; i < kTransformSize; ++i) {
      transform[static_cast<std::size_t>(i)] = message.transforms(step + i);
      require(std::isfinite(message.transforms(step + i)), "a transform that is not finite");
    }
    instance.transforms.push_back(transform);
  }
  return instance;
}

std::uint32_t checked_kernel(const v1::CompiledScene& message, std::uint32_t index) {
  require(index < static_cast<std::uint32_t>(message.kernels_size()),
          "a kernel index out of range");
  return index;
}

}  // namespace

TriangleMesh load_quad(const v1::Quad& q) {
  return quad_mesh(vector(q.corner(), "a quad's corner"), vector(q.edge_u(), "a quad's edge"),
                   vector(q.edge_v(), "a quad's edge"));
}

Sphere load_sphere(const v1::Sphere& s) {
  const auto centre = [](const v1::Vector& v) {
    vector(v, "a sphere's centre");
    return Double3(v.x(), v.y(), v.z());
  };
  const Double3 first = centre(s.centre());
  require(std::isfinite(s.radius()) && s.radius() > 0.0, "a sphere without a radius");
  require(s.later_centres_size() < 129, "a sphere with more than 129 time steps");
  Sphere sphere{first.x, first.y, first.z, s.radius()};
  for (const auto& later : s.later_centres()) sphere.later_centres.push_back(centre(later));
  return sphere;
}

LoadedShapes load_shapes(const LoadContext& context) {
  require(context.message.surfaces_size() > 0, "no surfaces");
  LoadedShapes loaded;
  for (const auto& surface : context.message.surfaces()) {
    throw_if_stopped(context.stop);
    loaded.shapes.push_back(load_shape(context, surface));
    loaded.groups.push_back(surface.group());
  }
  for (const auto& instance : context.message.instances()) {
    throw_if_stopped(context.stop);
    loaded.instances.push_back(load_instance(instance));
  }
  return loaded;
}

std::vector<Interior> load_interiors(const LoadContext& context) {
  const auto& message = context.message;
  require(message.interiors_size() <= static_cast<int>(InteriorList::kMaxBodies),
          "more interiors than 65535");
  std::vector<Interior> interiors;
  for (const auto& interior : message.interiors()) {
    const bool absorbs = interior.has_absorption();
    interiors.push_back(
        {interior.index_matched() ? Spectrum(1.0f) : context.spectrum(interior.index()),
         absorbs ? context.spectrum(interior.absorption()) : Spectrum(0.0f),
         absorbs,
         interior.priority(),
         interior.index_matched(),
         {interior.media().begin(), interior.media().end()},
         interior.has_outside() ? context.spectrum(interior.outside()) : Spectrum(1.0f)});
    require(interiors.back().index.least() >= 1e-3f && interiors.back().outside.least() >= 1e-3f,
            "an index of refraction below 0.001");
    require(!interior.has_outside() || !(absorbs || interior.index_matched() ||
                                         interior.media_size() > 0 || interior.priority() != 0),
            "a boundary between two indices that bounds a body");
    for (const std::uint32_t medium : interiors.back().media) {
      require(medium < static_cast<std::uint32_t>(message.media_size()),
              "a medium index out of range");
    }
  }
  return interiors;
}

InteriorList load_unbounded(const LoadContext& context) {
  const auto& message = context.message;
  require(message.unbounded_interiors_size() <= static_cast<int>(InteriorList::kMax),
          "more than 7 unbounded interiors");
  InteriorList everywhere;
  for (const std::uint32_t body : message.unbounded_interiors()) {
    require(body < static_cast<std::uint32_t>(message.interiors_size()),
            "an unbounded interior out of range");
    require(message.interiors(static_cast<int>(body)).index_matched(),
            "an unbounded interior that is a dielectric");
    everywhere.enter(body);
  }
  return everywhere;
}

std::vector<BumpMap> load_bump_maps(const LoadContext& context) {
  std::vector<BumpMap> bump_maps;
  for (const auto& surface : context.message.surfaces()) {
    if (surface.has_normal_map()) {
      bump_maps.push_back(BumpMap::of_normals(load_texture_use(context, surface.normal_map(), 3)));
    } else if (surface.has_bump_map()) {
      bump_maps.push_back(BumpMap::of_heights(load_texture_use(context, surface.bump_map(), 1)));
    }
  }
  return bump_maps;
}

std::vector<SurfaceMaterial> load_materials(const LoadContext& context,
                                            const std::vector<AnyKernel>& kernels,
                                            const std::vector<Shape>& shapes) {
  std::vector<SurfaceMaterial> materials;
  std::uint32_t bump_maps = 0;
  for (const auto& surface : context.message.surfaces()) {
    SurfaceMaterial material;
    material.front_kernel = checked_kernel(context.message, surface.kernel());
    material.back_kernel = surface.has_back_kernel()
                               ? checked_kernel(context.message, surface.back_kernel())
                               : material.front_kernel;
    if (surface.has_interior()) {
      require(surface.interior() < static_cast<std::uint32_t>(context.message.interiors_size()),
              "an interior index out of range");
      const auto& interior = context.message.interiors(static_cast<int>(surface.interior()));
      (interior.has_outside() ? material.boundary : material.interior) = surface.interior();
    }
    if (surface.has_normal_map() || surface.has_bump_map()) material.bump_map = bump_maps++;
    material.index_matched_only =
        surface.has_interior() &&
        context.message.interiors(static_cast<int>(surface.interior())).index_matched() &&
        std::holds_alternative<NullKernel>(kernels[material.front_kernel]) &&
        std::holds_alternative<NullKernel>(kernels[material.back_kernel]);
    material.has_delta_lobe = has_delta_lobe(kernels, material.front_kernel) ||
                              has_delta_lobe(kernels, material.back_kernel) ||
                              surface.has_interior();
    material.may_pass =
        may_pass(kernels, material.front_kernel) || may_pass(kernels, material.back_kernel);
    const bool has_normals = visit_shape(
        shapes[materials.size()], [](const TriangleMesh& mesh) { return !mesh.normals.empty(); },
        [](const Sphere&) { return false; });
    material.needs_detail = material.bump_map != SurfaceMaterial::kNone || has_normals ||
                            needs_detail(context.message, material.front_kernel) ||
                            needs_detail(context.message, material.back_kernel);
    materials.push_back(material);
  }
  return materials;
}

void set_closed(const std::vector<Shape>& shapes, const std::vector<SurfaceMaterial>& materials,
                const InteriorList& everywhere, std::vector<Interior>& interiors) {
  for (std::uint32_t i = 0; i < interiors.size(); ++i) {
    interiors[i].closed = !everywhere.holds(i);
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::uint32_t body = materials[i].interior;
    if (body == SurfaceMaterial::kNone) continue;
    interiors[body].closed = interiors[body].closed && is_closed(shapes[i]);
  }
}

}  // namespace nocturne

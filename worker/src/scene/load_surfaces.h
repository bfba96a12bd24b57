#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/bump_map.h"
#include "scene/interior_list.h"
#include "scene/load_context.h"
#include "scene/scene.h"
#include "surfaces/instance.h"
#include "surfaces/shapes.h"

namespace nocturne {

struct LoadedShapes {
  std::vector<Shape> shapes;          // by surface
  std::vector<std::uint32_t> groups;  // of each
  std::vector<Instance> instances;
};

LoadedShapes load_shapes(const LoadContext& context);
TriangleMesh load_quad(const v1::Quad& message);
Sphere load_sphere(const v1::Sphere& message);

std::vector<Interior> load_interiors(const LoadContext& context);
/// The bodies that all of space is inside of.
InteriorList load_unbounded(const LoadContext& context);
std::vector<BumpMap> load_bump_maps(const LoadContext& context);

/// By surface. Luminaires are set by their own loader.
std::vector<SurfaceMaterial> load_materials(const LoadContext& context,
                                            const std::vector<AnyKernel>& kernels,
                                            const std::vector<Shape>& shapes);

/// Which bodies are closed; those that are everywhere are not.
void set_closed(const std::vector<Shape>& shapes, const std::vector<SurfaceMaterial>& materials,
                const InteriorList& everywhere, std::vector<Interior>& interiors);

}  // namespace nocturne

#pragma once

#include <vector>

#include "luminaires/light_sampler.h"
#include "luminaires/luminaire.h"
#include "luminaires/photon_emitter.h"
#include "scene/load_context.h"
#include "scene/scene.h"

namespace nocturne {

/// Sets the materials' luminaires.
std::vector<Luminaire> load_luminaires(const LoadContext& context, const Geometry& geometry,
                                       std::vector<SurfaceMaterial>& materials);

LightSampler load_light_sampler(const LoadContext& context,
                                const std::vector<Luminaire>& luminaires, const Geometry& geometry,
                                const std::vector<std::uint32_t>& groups);

/// Around all surfaces that may keep light together; empty where there are none.
std::optional<Geometry::Ball> ball_of_gatherers(const Geometry& geometry,
                                                const std::vector<std::uint32_t>& groups,
                                                const std::vector<SurfaceMaterial>& materials,
                                                const std::vector<AnyKernel>& kernels,
                                                const std::vector<bool>& specular_like);

PhotonEmitter load_emitter(const LoadContext& context, const std::vector<Luminaire>& luminaires,
                           const LightSampler& lights, const Geometry& geometry,
                           const std::vector<std::uint32_t>& groups, const Sensor& sensor,
                           std::optional<Geometry::Ball> gathering);

}  // namespace nocturne
